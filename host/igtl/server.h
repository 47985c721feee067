#pragma once
// ScanSession -> your callbacks -> [IGTL SERVER] -> 3D Slicer and other programs
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "core/io/labels/label_table.h"
#include "core/slice/result.h"
#include "host/device/delivered_slice.h"
#include "host/scan/mesh_update.h"

namespace sonoloft::igtl {

struct ServerOptions {
  /// Where to listen, a number: 127.0.0.1 is for programs on this machine, 0.0.0.0 for everybody who reaches it.
  /// OpenIGTLink knows neither secrets nor users: whoever connects sees the meshes.
  std::string address = "127.0.0.1";
  std::uint16_t port = 18944;                    ///< 0: any that is free
  LabelTable labels;                             ///< what the devices of labels are called
  std::chrono::milliseconds mesh_interval{200};  ///< between two meshes, at least; longer where they are large
  std::chrono::milliseconds patience{5000};      ///< a client that takes nothing for so long is closed
};

struct ServerCounts {
  std::size_t clients = 0;     ///< now
  std::uint64_t accepted = 0;  ///< clients, so far
  std::uint64_t frozen = 0;    ///< of them closed, since they took nothing for longer than the patience
  std::uint64_t foreign = 0;   ///< of them closed, since what they sent was no OpenIGTLink
  std::uint64_t ignored = 0;   ///< messages of clients with a wrong check sum, or of a type that is not answered
  std::uint64_t surfaces = 0;  ///< POLYDATA sent, each one label of a mesh
  std::uint64_t poses = 0;     ///< TRANSFORM and TDATA sent
};

/// Serves what a scan shows to OpenIGTLink clients, up to 16 of them at once: surfaces as POLYDATA, one device each
/// label; the pose of the newest slice as TRANSFORM or TDATA, device ImageToReference. Frame: RAS, mm, the reference
/// frame taken as LPS. Every surface is complete, and where a client is slow the newest replaces those it did not
/// take. docs/openigtlink.md says who gets what.
///
/// Threads. Members may be called from any thread, callbacks of a scan included. One thread serves all clients; it
/// never waits for any of them.
class Server {
 public:
  /// Listens. @error invalid_argument (no such address), io_failed (the port is in use, or needs root; no more files)
  [[nodiscard]] static Result<std::unique_ptr<Server>> start(ServerOptions options = {});
  /// Closes all connections.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const;

  /// Shows this mesh from now on. @pre not null @cost none here: the messages are made by the server's thread
  void show(std::shared_ptr<const MeshUpdate> update);
  /// Shows the pose of this slice, if it is ok. @pre not null
  void show(std::shared_ptr<const device::DeliveredSlice> slice);

  [[nodiscard]] ServerCounts counts() const;

 private:
  class Loop;
  explicit Server(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

}  // namespace sonoloft::igtl
