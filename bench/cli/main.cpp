// The program `umbra`. Its commands are listed in commands.def.
#include "umbra/bench/cli/command.h"
#include "umbra/core/image/image_io.h"

int main(int argc, char** argv) {
    umbra::set_image_reader([](const std::filesystem::path& file) { return umbra::read_image(file).image; });
    return umbra::run_command_line(argc, argv);
}
