"""The messages of docs/contenders.md: the loop that the adapters beside this file share."""
import json
import sys
import time


def serve(contender, requests=sys.stdin, answers=sys.stdout):
    """Each message is a method of the contender that takes it and returns its answer; what it raises is an error."""
    for line in requests:
        message = json.loads(line)
        if message['message'] == 'end':
            break
        begin = time.perf_counter()
        try:
            answer = getattr(contender, message['message'])(message)
            if message['message'] not in ('hello', 'scene'):
                answer.setdefault('ms', 1000 * (time.perf_counter() - begin))
        except Exception as e:
            answer = {'error': f'{type(e).__name__}: {e}'}
        print(json.dumps(answer), file=answers, flush=True)
