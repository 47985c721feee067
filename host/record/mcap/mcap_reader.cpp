#include "host/record/mcap/mcap_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "host/record/mcap/mcap_decode.h"

namespace sonoloft::record::mcap {

Result<std::unique_ptr<McapReader>> McapReader::open(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0 && errno == ENOENT)
    return fail(ErrorCode::file_not_found, path.string() + ": there is no such file: check the path");
  struct stat status {};
  if (file < 0 || fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
    const int error = file < 0 ? errno : EINVAL;
    if (file >= 0) close(file);
    return fail(ErrorCode::io_failed,
                path.string() + ": " + std::generic_category().message(error) + ": name a file that can be read");
  }
  std::unique_ptr<McapReader> reader(new McapReader(path, file, static_cast<std::uint64_t>(status.st_size)));
  if (auto read = reader->read_opening(); !read) return tl::unexpected<Error>(read.error());
  return reader;
}

McapReader::McapReader(std::filesystem::path path, int file, std::uint64_t size)
    : path_(std::move(path)), file_(file), size_(size) {}

McapReader::~McapReader() {
  close(file_);
}

tl::unexpected<Error> McapReader::failure(ErrorCode code, const std::string& what) const {
  return fail(code, path_.string() + ": byte " + std::to_string(position_) + ": " + what);
}

tl::unexpected<Error> McapReader::damaged(const std::string& what) const {
  return failure(ErrorCode::parse_failed,
                 what + ": take another copy, or what comes before: truncate -s " + std::to_string(position_));
}

/// @return false where the file ends before
Result<bool> McapReader::read(std::size_t length, std::string& bytes) {
  bytes.resize(std::min<std::uint64_t>(length, size_ - offset_));
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset_ + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return failure(ErrorCode::io_failed, "cannot be read: check the disk");
    done += static_cast<std::size_t>(count);
  }
  offset_ += bytes.size();
  crc_ = crc32(bytes, crc_);
  return bytes.size() == length;
}

Result<void> McapReader::read_opening() {
  const auto magic = read(kMagic.size(), head_);
  if (!magic) return tl::unexpected<Error>(magic.error());
  if (head_ != kMagic)
    return failure(ErrorCode::unsupported_format, "this is no MCAP file: name a recording of `sonoloft record`");
  const auto whole = read_record();
  if (!whole) return tl::unexpected<Error>(whole.error());
  if (!*whole) return failure(ErrorCode::empty_input, "the file ends in its header: nothing was recorded");
  if (load<Opcode>(head_, 0) != Opcode::header) return damaged("no header where it is due");
  Fields fields(content_);
  profile_ = fields.text();
  library_ = fields.text();
  if (fields.is_short()) return damaged("the header is too short");
  return {};
}

/// The next record of the file: its opcode in head_, its content in content_. @return false where the file ends before
Result<bool> McapReader::read_record() {
  position_ = offset_;
  crc_before_ = crc_;
  auto whole = read(kRecordHeadLen, head_);
  if (!whole || !*whole) return whole;
  const auto length = load<std::uint64_t>(head_, 1);
  if (length > kMaxRecordLen) return damaged("a record of " + std::to_string(length) + " bytes");
  return read(static_cast<std::size_t>(length), content_);
}

Result<std::optional<Message>> McapReader::next() {
  while (true) {
    if (next_ != 0) {
      auto message = next_of_chunk();
      if (!message || *message) return message;
    }
    if (ended_) return std::nullopt;
    const auto whole = read_record();
    if (!whole) return tl::unexpected<Error>(whole.error());
    if (!*whole) {
      ended_ = true;
      cut_ = path_.string() + ": ends at byte " + std::to_string(size_) +
             (position_ == size_ ? "" : ", within the record that begins at byte " + std::to_string(position_)) +
             (data_ended_ ? ": no message is missing" : ": it was not recorded to its end");
      return std::nullopt;
    }
    if (auto taken = take(); !taken) return tl::unexpected<Error>(taken.error());
  }
}

Result<void> McapReader::take() {
  switch (const auto opcode = load<Opcode>(head_, 0)) {
    case Opcode::chunk:
      return data_ended_ ? damaged("a chunk in the summary") : take_chunk();
    case Opcode::channel:
      return take_channel(content_);
    case Opcode::data_end:
      return data_ended_ ? damaged("a second end of the data") : take_data_end();
    case Opcode::footer:
      return data_ended_ ? take_footer() : damaged("a footer before the end of the data");
    case Opcode::message:
      return failure(ErrorCode::unsupported_format, "a message outside of a chunk: write it in chunks");
    default:
      if (opcode == Opcode::header || opcode == Opcode{0} || (opcode > Opcode::data_end && opcode < Opcode{0x80}))
        return damaged("no record of kind " + std::to_string(static_cast<int>(opcode)) + " belongs here");
      return {};
  }
}

Result<void> McapReader::take_chunk() {
  Fields fields(content_);
  fields.take(16);  // its times
  const auto size = fields.number<std::uint64_t>();
  const auto crc = fields.number<std::uint32_t>();
  const std::string_view compression = fields.text();
  if (!fields.is_short() && !compression.empty())
    return failure(ErrorCode::unsupported_format,
                   "a chunk is compressed (" + std::string(compression) + "): decompress the file first");
  const auto length = fields.number<std::uint64_t>();
  if (fields.is_short() || length != fields.left().size() || size != length)
    return damaged("the lengths of a chunk do not agree");
  if (crc != 0 && crc32(fields.left()) != crc) return damaged("the sum over a chunk is wrong");
  next_ = content_.size() - fields.left().size();
  return {};
}

Result<void> McapReader::take_channel(std::string_view content) {
  Fields fields(content);
  const auto id = fields.number<std::uint16_t>();
  fields.number<std::uint16_t>();  // its schema
  const std::string_view topic = fields.text();
  if (fields.is_short()) return damaged("a channel is too short");
  if (topics_.try_emplace(id, topic).first->second != topic)
    return damaged("a channel is there twice, with two topics");
  return {};
}

/// The next message of the chunk at hand; nothing at its end.
Result<std::optional<Message>> McapReader::next_of_chunk() {
  while (next_ < content_.size()) {
    Fields fields(std::string_view(content_).substr(next_));
    const auto opcode = fields.number<Opcode>();
    const std::string_view content = fields.take(fields.number<std::uint64_t>());
    if (fields.is_short()) return damaged("a record goes beyond its chunk");
    next_ = content_.size() - fields.left().size();
    if (opcode == Opcode::channel) {
      if (auto taken = take_channel(content); !taken) return tl::unexpected<Error>(taken.error());
    }
    if (opcode != Opcode::message) continue;
    Fields message(content);
    const auto topic = topics_.find(message.number<std::uint16_t>());
    message.number<std::uint32_t>();  // its sequence
    const auto time_ns = message.number<std::uint64_t>();
    message.number<std::uint64_t>();  // when it was published
    if (message.is_short()) return damaged("a message is too short");
    if (topic == topics_.end()) return damaged("a message of a channel that is not there");
    return Message{topic->second, time_ns, bytes_of(message.left())};
  }
  next_ = 0;
  return std::nullopt;
}

Result<void> McapReader::take_data_end() {
  Fields fields(content_);
  const auto crc = fields.number<std::uint32_t>();
  if (fields.is_short()) return damaged("the end of the data is too short");
  if (crc != 0 && crc != crc_before_) return damaged("the sum over all before is wrong");
  data_ended_ = true;
  crc_ = 0;
  return {};
}

Result<void> McapReader::take_footer() {
  Fields fields(content_);
  fields.take(kFooterLen - sizeof(std::uint32_t));
  const auto crc = fields.number<std::uint32_t>();
  if (fields.is_short()) return damaged("the footer is too short");
  const std::string_view summed = std::string_view(content_).substr(0, kFooterLen - sizeof crc);
  if (crc != 0 && crc != crc32(summed, crc32(head_, crc_before_))) return damaged("the sum over the summary is wrong");
  position_ = offset_;
  std::string end;
  const auto read_all =
      read(static_cast<std::size_t>(std::min<std::uint64_t>(size_ - offset_, kMagic.size() + 1)), end);
  if (!read_all) return tl::unexpected<Error>(read_all.error());
  if (!kMagic.starts_with(end)) return damaged("the file does not end where it says");
  ended_ = true;
  if (end != kMagic) cut_ = path_.string() + ": ends at byte " + std::to_string(size_) + ": no message is missing";
  return {};
}

}  // namespace sonoloft::record::mcap
