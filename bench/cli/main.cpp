// The program `umbra`. Its commands are listed in commands.def.
#include "umbra/bench/cli/command.h"

int main(int argc, char** argv) { return umbra::run_command_line(argc, argv, umbra::commands()); }
