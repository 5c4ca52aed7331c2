// Joins renders of adjacent ranges of samples (--first-sample) into one: merge_images A.exr B.exr … -o C.exr
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "error.h"
#include "files/file.h"
#include "film/film_file.h"
#include "platform.h"

int main(int argument_count, char** arguments) {
    lab::prepare_program();
    CLI::App app("Joins renders of adjacent ranges of samples", "merge_images");
    app.footer("Exit codes: 0 done, 1 bad input or usage.");
    std::vector<std::filesystem::path> parts;
    std::filesystem::path output;
    app.add_option("parts", parts, "EXR files written by a chapter, in any order")->required();
    app.add_option("-o,--output", output, "EXR file to write")->required();
    try {
        app.parse(argument_count, arguments);
        output = lab::expand_home(output);
        std::error_code none;  // where it does not exist
        for (const auto& part : parts)
            if (std::filesystem::equivalent(part, output, none))
                throw lab::UserError(output.string() + ": would replace one of the files that are joined: choose another name");
        lab::check_writable(output, {".exr"});
        const lab::FilmFile merged = lab::merge_films(parts);
        lab::write_film(output, merged.image, merged.header);
        std::printf("%s: samples %u to %u\n", output.string().c_str(), merged.header.first_sample,
                    merged.header.first_sample + merged.image.min_samples() - 1);
        return 0;
    } catch (const CLI::CallForHelp&) {
        std::cout << app.help();
        return 0;
    } catch (const CLI::ParseError& error) {
        std::cerr << "error: merge_images: " << error.what() << " (--help shows how it is used)\n";
        return 1;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    }
}
