#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lodestone::common {

/// Throws IoError naming the path unless it is a file that lies on a disk: a pipe would be waited for, and a
/// device may have no end.
void check_is_file(const std::string& path);

/// Whole file as bytes. Throws IoError naming the path when it cannot be read, is a folder, a pipe or a
/// device, or larger than `largest_bytes`.
std::string read_file(const std::string& path, std::size_t largest_bytes = std::size_t{2} << 30);

/// Writes to a temporary name beside `path`, fsyncs and renames, so that `path` holds either the old or the
/// new content, never a part. Throws IoError (disk full, no permission) and leaves `path` as it was.
void write_file_atomically(const std::string& path, std::string_view content);

/// Gives the file `staged`, which is written and closed, the name `path`, in the place of what had it. Both
/// must be on one file system. Throws IoError; `path` is then unchanged.
void replace_file(const std::string& staged, const std::string& path);

/// Nothing where there is none. Throws IoError.
void remove_file(const std::string& path);

/// Replaces folder `path` by folder `staged` in one step (renames; exchanges the two names when `path` exists
/// and then removes the old content). Both must be on one file system. Throws IoError; `path` is then
/// unchanged.
void replace_folder(const std::string& staged, const std::string& path);

/// fsync of a file or folder. Throws IoError.
void sync_path(const std::string& path);

/// Makes a folder and its parents. Throws IoError.
void make_folders(const std::string& path);

/// Lower-case hex SHA-256 of `content`.
std::string sha256(std::string_view content);

}  // namespace lodestone::common
