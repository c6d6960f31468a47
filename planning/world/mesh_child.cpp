/// Assimp in a forked child: a crash, a loop or a bloat there is an error message here.

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/text.h"
#include "planning/world/mesh_file.h"

namespace longarm::planning::internal {
namespace {

constexpr rlim_t kCpuSeconds = 10;
constexpr rlim_t kMemory = rlim_t{2} << 30;
constexpr int kWallMilliseconds = 20000;

/// What the child writes first; then vertices (3 doubles each) and triangles (3 int32 each).
struct Header {
  std::uint32_t magic = 0x4c41524d;
  std::uint32_t failed = 0;         ///< Then `vertices` bytes of a message follow instead.
  std::uint64_t vertices = 0, triangles = 0;
};

/// Lets a mesh file refer to no other file.
class NoFiles final : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

bool writeAll(int fd, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = ::write(fd, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

void writeFailure(int fd, const std::string& why) {
  Header header;
  header.failed = 1;
  header.vertices = std::min<std::size_t>(why.size(), 300);
  if (writeAll(fd, &header, sizeof header)) writeAll(fd, why.data(), header.vertices);
}

void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, std::vector<double>& vertices,
             std::vector<std::int32_t>& triangles) {
  const aiMatrix4x4 here = parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    const auto first = static_cast<std::int32_t>(vertices.size() / 3);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = here * mesh.mVertices[v];
      vertices.insert(vertices.end(), {double(p.x), double(p.y), double(p.z)});
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      for (unsigned i = 0; i < 3; ++i) triangles.push_back(first + static_cast<std::int32_t>(face.mIndices[i]));
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect(scene, *node.mChildren[c], here, vertices, triangles);
}

void importAndWrite(int fd, std::string_view content, const std::string& ending, const MeshLimits& limits) {
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);  // As ROS tools read robots.
  const aiScene* scene =
      importer.ReadFileFromMemory(content.data(), content.size(),
                                  aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType |
                                      aiProcess_RemoveComponent,
                                  ending.c_str());
  if (scene == nullptr || scene->mRootNode == nullptr) return writeFailure(fd, importer.GetErrorString());
  std::vector<double> vertices;
  std::vector<std::int32_t> triangles;
  collect(*scene, *scene->mRootNode, aiMatrix4x4(), vertices, triangles);
  Header header;
  header.vertices = vertices.size() / 3;
  header.triangles = triangles.size() / 3;
  if (header.triangles > limits.max_triangles) return writeFailure(fd, "too many triangles");
  if (!writeAll(fd, &header, sizeof header)) return;
  if (!writeAll(fd, vertices.data(), vertices.size() * sizeof(double))) return;
  writeAll(fd, triangles.data(), triangles.size() * sizeof(std::int32_t));
}

/// Address space already in use [bytes], which the child inherits.
rlim_t inheritedMemory() {
  const auto text = readTextFile("/proc/self/statm", 4096);
  if (!text) return 0;
  const auto pages = parseInteger(std::string_view(*text).substr(0, text->find(' ')));
  return static_cast<rlim_t>(pages.value_or(0)) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

void limitSelf(rlim_t inherited) {
  const rlimit cpu{kCpuSeconds, kCpuSeconds + 1}, no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &cpu);
  ::setrlimit(RLIMIT_CORE, &no_core);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // They reserve terabytes of addresses.
  const rlimit memory{inherited + kMemory, inherited + kMemory};
  ::setrlimit(RLIMIT_AS, &memory);
#else
  (void)inherited;
#endif
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) ::signal(signal, SIG_DFL);
}

[[noreturn]] void runChild(int fd, std::string_view content, const std::string& ending, const MeshLimits& limits,
                           rlim_t inherited) {
  limitSelf(inherited);
  try {
    importAndWrite(fd, content, ending, limits);
  } catch (const std::exception& e) {
    writeFailure(fd, e.what());
  } catch (...) {
    writeFailure(fd, "unknown exception");
  }
  ::_exit(0);
}

/// Everything the child sends, until it ends, sends too much or takes too long.
std::string readReply(int fd, std::size_t most, bool& timed_out) {
  std::string reply;
  char buffer[65536];
  pollfd waiting{fd, POLLIN, 0};
  for (;;) {
    const int ready = ::poll(&waiting, 1, kWallMilliseconds);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      timed_out = true;
      return reply;
    }
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0 || reply.size() > most) return reply;
    reply.append(buffer, static_cast<std::size_t>(n));
  }
}

Error invalid(const std::string& name, const std::string& what) {
  return {ErrorCode::kInvalidInput, name + ": " + what};
}

std::string endOf(int status, bool timed_out) {
  if (timed_out || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))) {
    return "the mesh reader took longer than " + std::to_string(kCpuSeconds) + " s; the file is refused";
  }
  if (WIFSIGNALED(status)) {
    return "the mesh reader crashed on it (signal " + std::to_string(WTERMSIG(status)) + "); the file is refused";
  }
  return "the mesh reader ended without an answer; the file is refused";
}

Result<TriangleMesh> decode(const std::string& reply, const std::string& name, const std::string& end) {
  Header header;
  if (reply.size() < sizeof header) return invalid(name, end);
  std::memcpy(&header, reply.data(), sizeof header);
  const std::string_view body = std::string_view(reply).substr(sizeof header);
  if (header.failed != 0) return invalid(name, "not readable: " + std::string(body.substr(0, 300)));
  const std::size_t vertex_bytes = header.vertices * 3 * sizeof(double);
  const std::size_t triangle_bytes = header.triangles * 3 * sizeof(std::int32_t);
  if (body.size() != vertex_bytes + triangle_bytes) return invalid(name, end);
  TriangleMesh mesh;
  mesh.vertices.resize(header.vertices);
  mesh.triangles.resize(header.triangles);
  if (vertex_bytes > 0) std::memcpy(mesh.vertices.data()->data(), body.data(), vertex_bytes);
  if (triangle_bytes > 0) std::memcpy(mesh.triangles.data()->data(), body.data() + vertex_bytes, triangle_bytes);
  return mesh;
}

}  // namespace

Result<TriangleMesh> readMeshInChild(std::string_view content, const std::string& ending, const std::string& name,
                                     const MeshLimits& limits) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return Error{ErrorCode::kInternal, name + ": no pipe for the mesh reader"};
  const rlim_t inherited = inheritedMemory();
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    return Error{ErrorCode::kInternal, name + ": no process for the mesh reader"};
  }
  if (child == 0) {
    ::close(ends[0]);
    runChild(ends[1], content, ending, limits, inherited);
  }
  ::close(ends[1]);
  bool timed_out = false;
  const std::string reply = readReply(ends[0], limits.max_triangles * 100 + 1024, timed_out);
  ::close(ends[0]);
  int status = 0;
  ::kill(child, timed_out ? SIGKILL : SIGCONT);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return decode(reply, name, endOf(status, timed_out));
}

}  // namespace longarm::planning::internal
