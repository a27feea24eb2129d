#include "core/imaging/unpack.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <vector>

#include "core/base/stop.h"

namespace fascicle {
namespace {

enum class StreamState { kMore, kEnd, kError };

constexpr std::size_t kMostAtOnce = 1 << 30;  // both libraries count in 32 bits

class Inflater {
 public:
  explicit Inflater(Compression compression) {
    constexpr int kEitherHeader = 15 + 32, kNoHeader = -15;
    ok_ = inflateInit2(&stream_, compression == Compression::kDeflateOnly ? kNoHeader : kEitherHeader) == Z_OK;
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  // Takes bytes from the start of `in` and fills the start of `out`; `made` is the number of bytes written.
  StreamState Run(std::string_view& in, std::vector<char>& out, std::size_t& made) {
    stream_.next_in = reinterpret_cast<unsigned char*>(const_cast<char*>(in.data()));
    stream_.avail_in = static_cast<unsigned>(std::min(in.size(), kMostAtOnce));
    stream_.next_out = reinterpret_cast<unsigned char*>(out.data());
    stream_.avail_out = static_cast<unsigned>(out.size());
    const unsigned given = stream_.avail_in;
    const int state = ok_ ? inflate(&stream_, Z_NO_FLUSH) : Z_MEM_ERROR;
    in.remove_prefix(given - stream_.avail_in);
    made = out.size() - stream_.avail_out;
    return state == Z_OK ? StreamState::kMore : state == Z_STREAM_END ? StreamState::kEnd : StreamState::kError;
  }
  static bool Starts(std::string_view in) { return in.starts_with("\x1f\x8b"); }

 private:
  z_stream stream_ = {};
  bool ok_ = false;
};

class Bunzipper {
 public:
  explicit Bunzipper(Compression) { ok_ = BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK; }
  ~Bunzipper() { BZ2_bzDecompressEnd(&stream_); }
  Bunzipper(const Bunzipper&) = delete;
  Bunzipper& operator=(const Bunzipper&) = delete;

  StreamState Run(std::string_view& in, std::vector<char>& out, std::size_t& made) {
    stream_.next_in = const_cast<char*>(in.data());
    stream_.avail_in = static_cast<unsigned>(std::min(in.size(), kMostAtOnce));
    stream_.next_out = out.data();
    stream_.avail_out = static_cast<unsigned>(out.size());
    const unsigned given = stream_.avail_in;
    const int state = ok_ ? BZ2_bzDecompress(&stream_) : BZ_MEM_ERROR;
    in.remove_prefix(given - stream_.avail_in);
    made = out.size() - stream_.avail_out;
    return state == BZ_OK ? StreamState::kMore : state == BZ_STREAM_END ? StreamState::kEnd : StreamState::kError;
  }
  static bool Starts(std::string_view in) { return in.starts_with("BZh"); }

 private:
  bz_stream stream_ = {};
  bool ok_ = false;
};

template <class Reader>
bool RunStreams(Compression compression, std::string_view packed, std::uint64_t most, std::string& out,
                const std::stop_token& stop) {
  std::vector<char> scratch(1 << 18);
  std::uint64_t kept = 0;
  do {
    Reader reader(compression);
    StreamState state = StreamState::kMore;
    while (state == StreamState::kMore) {
      ThrowIfStopped(stop);
      std::size_t made = 0;
      const std::size_t before = packed.size();
      state = reader.Run(packed, scratch, made);
      // Neither taken nor made anything: the stream lacks its end.
      if (state == StreamState::kMore && made == 0 && packed.size() == before) state = StreamState::kError;
      const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(made, most - kept));
      out.append(scratch.data(), wanted);
      kept += wanted;
    }
    if (state == StreamState::kError) return false;
  } while (Reader::Starts(packed));
  return true;
}

}  // namespace

bool Unpack(Compression compression, std::string_view packed, std::uint64_t most, std::string& out,
            const std::stop_token& stop, Problems& problems) {
  const bool done = compression == Compression::kBzip2 ? RunStreams<Bunzipper>(compression, packed, most, out, stop)
                                                       : RunStreams<Inflater>(compression, packed, most, out, stop);
  if (!done) problems.Add("", "the file's compressed voxels are incomplete or damaged", "is it complete?");
  return done;
}

}  // namespace fascicle
