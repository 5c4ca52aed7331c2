// What differs between operating systems. Nothing else asks which one it is.
#pragma once
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <vector>

namespace lab {

// Called first by a program that people start: on Windows its terminal shows UTF-8 and understands control
// sequences, and one that was opened for this program alone, by a double click, waits for the Enter key at
// the end, so that messages can be read.
void prepare_terminal();

// Whether people read what is written there.
bool is_terminal(std::FILE* stream);

// From now on bytes are written as they are: Windows gives lines other ends.
void make_binary(std::FILE* stream);

// What windows can be shown by, what is to be tried first before the others. Only Linux has a choice.
enum class WindowSystem { wayland, x11, other };
std::vector<WindowSystem> window_systems();

// Whether the program would be there after a step that might bring it down. Linux, where libraries come from
// elsewhere, has a child process find out, and nothing of what it prints is shown.
bool would_survive(int (*step)());

// Its file, or empty where that is not known.
std::filesystem::path running_program();

// The user's own folder, or empty where nobody says which it is.
std::filesystem::path user_folder();

int process_id();

// Processors that the program may use.
size_t processor_count();

// Whether what was written, flushed included, is on the disk; if not, errno says why.
bool write_to_disk(std::FILE* stream);

// Gives a file another name, also one that another file has, in one step. On Windows a scanner for viruses
// can hold a file that was just written: this waits for it, for a second at most.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to, std::error_code& error);

// How to get a Vulkan driver here, in words that follow "install ".
extern const char* const vulkan_driver;

// From now on the first Ctrl-C (or SIGTERM) only makes is_interrupted() true; the second one ends the
// program.
void install_interrupt_handler();
bool is_interrupted();

}  // namespace lab
