#include "files/file.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "error.h"
#include "platform.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

// What a write to this name replaces: a symbolic link stays one, and the file that it leads to is written.
fs::path target_of(const fs::path& file) {
    constexpr int max_links = 40;  // as in Linux
    const auto fail = [&](const char* reason) { throw UserError(file.string() + ": cannot be written: " + reason); };
    std::error_code error;
    fs::path target = file;
    for (int links = 0; fs::is_symlink(target, error); ++links) {
        if (links == max_links) fail("too many symbolic links");
        target = target.parent_path() / fs::read_symlink(target, error);
    }
    const fs::file_status status = fs::status(target, error);
    if (fs::exists(status) && !fs::is_regular_file(status)) fail("not a regular file");
    return target;
}

// In the target's folder, because renaming is atomic only within a file system. The process id separates two programs that write
// the same file, and the count two threads.
fs::path temporary_name(const fs::path& file) {
    static std::atomic<uint64_t> count = 0;
    fs::path name = ".";
    name += file.filename();
    name += '.';
    name += std::to_string(process_id()) + '.' + std::to_string(count++);
    name += ".tmp";
    return file.parent_path() / name;
}

// Whether all bytes were written: a full disk may show only on flush or close. The file gets the mode of the one that it will
// replace, if there is one.
bool write_bytes(const fs::path& file, const fs::path& replaced, std::span<const std::string_view> parts) {
    std::FILE* stream = std::fopen(file.string().c_str(), "wb");
    if (!stream) return false;
    std::error_code ignored;
    const fs::file_status status = fs::status(replaced, ignored);
    if (fs::exists(status)) fs::permissions(file, status.permissions(), ignored);
    const bool written = std::ranges::all_of(
        parts, [&](std::string_view part) { return std::fwrite(part.data(), 1, part.size(), stream) == part.size(); });
    // The contents must reach the disk before the rename, or a power failure could leave an empty file.
    const bool flushed = std::fflush(stream) == 0 && write_to_disk(stream);
    const int error = errno;
    const bool closed = std::fclose(stream) == 0;
    if (!written || !flushed) errno = error;
    return written && flushed && closed;
}

}  // namespace

std::string read_file(const fs::path& file, uint64_t max_bytes) {
    const std::string name = file.string();
    constexpr size_t max_name_length = 1000;
    if (printable(name) != name || name.size() > max_name_length)
        throw UserError(in_quotes(name) + ": a file name may have no control characters and at most 1000 others");
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) throw UserError(name + ": no such file");
    if (!fs::is_regular_file(status)) throw UserError(name + ": not a regular file");
    const uint64_t size = fs::file_size(file, error);
    if (error) throw UserError(name + ": " + error.message());
    if (size == 0) throw UserError(name + ": the file is empty");
    if (size > max_bytes)
        throw UserError(name + ": the file has " + std::to_string(size >> 20) + " MiB, the limit is " +
                        std::to_string(max_bytes >> 20) + " MiB");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw UserError(name + ": cannot be opened: " + std::strerror(errno));
    std::string bytes(size, '\0');
    if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) throw UserError(name + ": cannot be read completely");
    return bytes;
}

void write_file(const fs::path& file, std::string_view bytes) { write_file(file, {&bytes, 1}); }

void write_file(const fs::path& file, std::span<const std::string_view> parts) {
    const fs::path target = target_of(file), temporary = temporary_name(target);
    std::error_code error;
    if (!write_bytes(temporary, target, parts))
        error = {errno, std::generic_category()};
    else
        rename_file(temporary, target, error);
    if (!error) return;
    const std::string reason = error.message();
    fs::remove(temporary, error);
    throw UserError(file.string() + ": cannot be written: " + reason);
}

void check_writable(const fs::path& file, const std::vector<std::string>& endings) {
    const std::string name = file.string();
    if (std::find(endings.begin(), endings.end(), lower_case_extension(file)) == endings.end()) {
        std::string known;
        for (const auto& ending : endings) known += (known.empty() ? "" : ending == endings.back() ? " or " : ", ") + ending;
        throw UserError(name + ": the name must end in " + known);
    }
    std::error_code error;
    if (fs::is_directory(file, error)) throw UserError(name + ": cannot be written: it is a folder");
    if (file.has_parent_path()) {
        fs::create_directories(file.parent_path(), error);
        if (error) throw UserError(name + ": its folder cannot be created: " + error.message());
    }
    const fs::path target = target_of(file), temporary = temporary_name(target);
    const bool writable = write_bytes(temporary, target, {});
    const std::string reason = std::strerror(errno);
    fs::remove(temporary, error);
    if (!writable) throw UserError(name + ": cannot be written: " + reason);
}

fs::path expand_home(const fs::path& path) {
    const std::string name = path.string();
    return name.starts_with("~/") ? user_folder() / name.substr(2) : path;
}

std::string printable(std::string_view text) {
    std::string result(text);
    std::replace_if(
        result.begin(), result.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
    return result;
}

std::string in_quotes(std::string_view name) {
    constexpr size_t max_length = 80;
    return '"' + printable(name.substr(0, max_length)) + (name.size() > max_length ? "...\"" : "\"");
}

std::string lower_case_extension(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace lab
