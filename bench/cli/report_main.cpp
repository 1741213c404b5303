// `umbra report` without the other commands: links as little as its first page needs.
#include "umbra/bench/cli/command.h"

int main(int argc, char** argv) { return umbra::run_command_line(argc, argv, {&umbra::report_line, 1}); }
