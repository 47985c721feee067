#include "host/record/mcap/mcap_writer.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "host/record/mcap/mcap_encode.h"

namespace sonoloft::record::mcap {
namespace {

std::string encoded(const Schema& schema) {
  std::string content, record;
  append(content, schema.id);
  for (const std::string& field : {schema.name, schema.encoding, schema.data}) append_text(content, field);
  append_record(record, Opcode::schema, content);
  return record;
}

std::string encoded(const Channel& channel) {
  std::string content, record;
  append(content, channel.id);
  append(content, channel.schema);
  append_text(content, channel.topic);
  append_text(content, channel.encoding);
  append_text(content, "");  // metadata: none
  append_record(record, Opcode::channel, content);
  return record;
}

std::string encoded(std::uint16_t channel, const std::vector<McapChunk::Entry>& entries) {
  std::string content, times, record;
  for (const auto& [time_ns, offset] : entries) {
    append(times, time_ns);
    append(times, offset);
  }
  append(content, channel);
  append_text(content, times);
  append_record(record, Opcode::message_index, content);
  return record;
}

}  // namespace

std::uint32_t crc32(std::string_view bytes, std::uint32_t crc) {
  return static_cast<std::uint32_t>(crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

Result<std::unique_ptr<McapWriter>> McapWriter::create(const std::filesystem::path& path, const Opening& opening) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0 && errno == EEXIST)
    return fail(ErrorCode::io_failed, path.string() + ": there is one already, and it is kept: name another file");
  if (file < 0)
    return fail(ErrorCode::io_failed,
                path.string() + ": cannot be made: " + std::generic_category().message(errno) + ": check the folder");
  std::unique_ptr<McapWriter> writer(new McapWriter(path, file, opening));
  std::string header, start(kMagic);
  append_text(header, opening.profile);
  append_text(header, opening.library);
  append_record(start, Opcode::header, header);
  if (auto begun = writer->put(start + writer->opening_); !begun) return tl::unexpected<Error>(begun.error());
  return writer;
}

McapWriter::McapWriter(std::filesystem::path path, int file, const Opening& opening)
    : path_(std::move(path)),
      file_(file),
      schemas_(static_cast<std::uint16_t>(opening.schemas.size())),
      channels_(static_cast<std::uint32_t>(opening.channels.size())) {
  for (const Schema& schema : opening.schemas) opening_ += encoded(schema);
  for (const Channel& channel : opening.channels) opening_ += encoded(channel);
}

McapWriter::~McapWriter() {
  close(file_);
}

tl::unexpected<Error> McapWriter::failure(int error) const {
  return fail(ErrorCode::io_failed, path_.string() + ": " + std::generic_category().message(error) +
                                        ": what was recorded before can be read; record on another disk");
}

Result<void> McapWriter::put(const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = ::write(file_, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno != EINTR) return failure(errno);
    done += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
  offset_ += bytes.size();
  crc_ = crc32(bytes, crc_);
  return {};
}

Result<void> McapWriter::write(const McapChunk& chunk) {
  std::string bytes = chunk.encoded();
  const std::uint64_t length = bytes.size();
  std::map<std::uint16_t, std::uint64_t> indexes;
  for (const auto& [channel, entries] : chunk.index()) {
    indexes[channel] = offset_ + bytes.size();
    messages_[channel] += entries.size();
    bytes += encoded(channel, entries);
  }
  std::string content;
  append(content, chunk.start_ns());
  append(content, chunk.end_ns());
  append(content, offset_);
  append(content, length);
  append_map(content, indexes);
  append(content, static_cast<std::uint64_t>(bytes.size() - length));
  append_text(content, "");  // not compressed
  append(content, static_cast<std::uint64_t>(chunk.size()));
  append(content, static_cast<std::uint64_t>(chunk.size()));
  append_record(chunk_indexes_, Opcode::chunk_index, content);
  start_ns_ = chunks_ == 0 ? chunk.start_ns() : std::min(start_ns_, chunk.start_ns());
  end_ns_ = std::max(end_ns_, chunk.end_ns());
  ++chunks_;
  return put(bytes);
}

Result<void> McapWriter::write_metadata(const std::string& name, const std::map<std::string, std::string>& values) {
  std::string content, record, index;
  append_text(content, name);
  append_map(content, values);
  append_record(record, Opcode::metadata, content);
  append(index, offset_);
  append(index, static_cast<std::uint64_t>(record.size()));
  append_text(index, name);
  append_record(metadata_indexes_, Opcode::metadata_index, index);
  ++metadata_;
  return put(record);
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : messages_) messages += count;
  std::string content, record;
  append(content, messages);
  append(content, schemas_);
  append(content, channels_);
  append(content, std::uint32_t{0});  // attachments
  append(content, metadata_);
  append(content, chunks_);
  append(content, start_ns_);
  append(content, end_ns_);
  append_map(content, messages_);
  append_record(record, Opcode::statistics, content);
  return record;
}

Result<void> McapWriter::finish() {
  std::string end, summed;
  append_record(end, Opcode::data_end, std::string(reinterpret_cast<const char*>(&crc_), sizeof crc_));
  if (auto ended = put(end); !ended) return ended;
  summed = opening_ + statistics() + chunk_indexes_ + metadata_indexes_;
  append(summed, Opcode::footer);
  append(summed, static_cast<std::uint64_t>(kFooterLen));
  append(summed, offset_);           // where the summary starts
  append(summed, std::uint64_t{0});  // no summary offsets
  append(summed, crc32(summed));
  return put(summed.append(kMagic));
}

Result<void> McapWriter::sync() {
  if (fdatasync(file_) != 0) return failure(errno);
  return {};
}

}  // namespace sonoloft::record::mcap
