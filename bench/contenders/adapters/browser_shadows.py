#!/usr/bin/env python3
"""The real-time shadows of three.js or Babylon.js as a contender, in a headless Chromium.

    browser_shadows.py threejs | babylonjs

Needs only Python's own library; Debian's `chromium` in PATH, or where $CHROMIUM says; and the library from npm:
`npm install --prefix ~/.cache/umbra/npm three babylonjs`, or another folder, which $UMBRA_NPM names.

This file starts the browser and serves its page, the library and the files of the protocol from a port of this
machine; the page asks for the next message, so no package drives the browser. What is the same for both libraries is in
browser_page.js, the rest in threejs.js and babylonjs.js.

Points are asked, not pictures: each is drawn as a point of one pixel, with its own place in the world, by a material of
the library, and what is read is the shadow factor of its shader. So nothing is rounded to pixels, and neither fall-off, a
spot's cone, N.L, colour management, sRGB nor tone mapping takes part, as they do in the ratio of two pictures.

OpenGL is SwiftShader's, on the processor: the same numbers everywhere, and times that say nothing about a GPU.
UMBRA_ANGLE=vulkan (gl, d3d11, metal) takes the GPU instead.

Traps:
- Without --enable-unsafe-swiftshader new browsers have no WebGL where there is no GPU.
- finish() returns early in a browser: work is over when a pixel has been read.
- Requests to this port must not go to a proxy.
"""
import http.server
import json
import os
import queue
import secrets
import shutil
import subprocess
import sys
import tempfile
import threading

from protocol import serve

LIBRARIES = {'threejs': ('three', 'build/three.module.js'), 'babylonjs': ('babylonjs', 'babylon.js')}  # package, file
HERE = os.path.dirname(os.path.abspath(__file__))
NPM = os.environ.get('UMBRA_NPM') or os.path.expanduser('~/.cache/umbra/npm')
FLAGS = ['--headless=new', '--use-angle=' + os.environ.get('UMBRA_ANGLE', 'swiftshader'), '--enable-unsafe-swiftshader',
         '--ignore-gpu-blocklist', '--no-sandbox', '--no-first-run', '--no-proxy-server', '--disable-extensions',
         '--disable-background-networking', '--disable-component-update', '--disable-sync', '--mute-audio']
START = 60  # seconds until the page must have said what it is


class Contender:
    failed = None

    def __init__(self, library):
        self.library, (self.package, self.module) = library, LIBRARIES[library]
        self.messages, self.answers = queue.Queue(), queue.Queue()
        self.browser, self.folder = None, ''
        self.profile = tempfile.TemporaryDirectory(prefix='umbra-browser-', ignore_cleanup_errors=True)

    def hello(self, message):
        try:
            self.folder = message['folder']
            return {**(self.ask(message) if self.browser else self.start()), 'version': self.version}
        except Exception as e:
            self.failed = e
            raise

    def start(self):
        chromium = os.environ.get('CHROMIUM') or shutil.which('chromium') or shutil.which('google-chrome')
        if not chromium:
            raise FileNotFoundError('chromium is not in PATH: install the package chromium, or set CHROMIUM')
        installed = os.path.join(NPM, 'node_modules', self.package)
        if not os.path.exists(os.path.join(installed, self.module)):
            raise FileNotFoundError(f'{self.package} is not in {NPM}: npm install --prefix {NPM} {self.package}')
        with open(os.path.join(installed, 'package.json'), encoding='utf-8') as file:
            self.version = json.load(file)['version']
        port = self.listen({'code': HERE, 'npm': installed})
        self.log = os.path.join(self.profile.name, 'log')
        with open(self.log, 'wb') as log:
            self.browser = subprocess.Popen([chromium, *FLAGS, '--user-data-dir=' + self.profile.name, port],
                                            stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        return self.ask(None, START)

    def ask(self, message, seconds=None):
        """The page's answer; None only waits for it."""
        if message:
            self.messages.put(message)
        waited = 0
        while True:
            try:
                answer = self.answers.get(timeout=1)
                break
            except queue.Empty:
                waited += 1
                if self.browser.poll() is not None or (seconds and waited >= seconds):
                    with open(self.log, encoding='utf-8', errors='replace') as log:
                        raise RuntimeError('the browser ' + ('does not answer: ' if self.browser.poll() is None else
                                                             'ended: ') + log.read()[-600:])
        if 'error' in answer:
            raise RuntimeError(answer['error'])
        return answer

    scene = build = points = aim = visibility = ask

    def end(self):
        if self.browser:
            self.browser.terminate()
            try:
                self.browser.wait(5)
            except subprocess.TimeoutExpired:
                self.browser.kill()
        self.profile.cleanup()

    def listen(self, folders):
        """The address of the page. Its first part is secret: other users of this machine may reach the port."""
        contender, secret = self, secrets.token_urlsafe()
        html = ('<!doctype html><meta charset="utf-8"><script type="importmap">{"imports": {"%s": "./npm/%s"}}</script>'
                '<script type="module" src="code/%s.js"></script>' % (self.package, self.module, self.library))

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version, disable_nagle_algorithm = 'HTTP/1.1', True  # else each answer takes 40 ms

            def log_message(self, *_):
                pass

            def reply(self, content, kind, status=200):
                self.send_response(status)
                self.send_header('Content-Type', kind)
                self.send_header('Content-Length', str(len(content)))
                self.send_header('Cache-Control', 'no-store')
                self.end_headers()
                self.wfile.write(content)

            def file(self, name):
                """data/FILE is of the protocol's folder, code/FILE of this one, npm/FILE of the library's."""
                folder, _, rest = name.partition('/')
                root = os.path.realpath({**folders, 'data': contender.folder}[folder])
                path = os.path.realpath(os.path.join(root, rest))
                if os.path.commonpath([root, path]) != root:
                    raise FileNotFoundError(name)
                return path

            def do_GET(self):
                try:
                    before, _, name = self.path[1:].partition('/')
                    if before != secret:
                        raise FileNotFoundError
                    if name == 'next':
                        self.reply(json.dumps(contender.messages.get()).encode(), 'application/json')
                    elif not name:
                        self.reply(html.encode(), 'text/html')
                    else:
                        with open(self.file(name), 'rb') as file:
                            self.reply(file.read(), 'text/javascript' if name.endswith('.js') else 'application/octet-stream')
                except (OSError, KeyError):
                    self.reply(b'', 'text/plain', 404)

            def do_POST(self):
                content = self.rfile.read(int(self.headers['Content-Length']))
                before, _, name = self.path[1:].partition('/')
                if before != secret:
                    self.reply(b'', 'text/plain', 404)
                elif name == 'answer':
                    self.reply(b'', 'text/plain')
                    contender.answers.put(json.loads(content))
                else:
                    with open(self.file(name), 'wb') as file:
                        file.write(content)
                    self.reply(b'', 'text/plain')

        server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), Handler)
        server.daemon_threads = True
        threading.Thread(target=server.serve_forever, daemon=True).start()
        return f'http://127.0.0.1:{server.server_port}/{secret}/'


if len(sys.argv) != 2 or sys.argv[1] not in LIBRARIES:
    sys.exit('usage: browser_shadows.py ' + ' | '.join(LIBRARIES))
contender = Contender(sys.argv[1])
try:
    serve(contender)
finally:
    contender.end()
if contender.failed:
    sys.exit(f'browser_shadows.py: {contender.failed}')
