// Wavefront OBJ: positions and faces [Wavefront, "Advanced Visualizer Manual", appendix B1].
#include <algorithm>
#include <string>
#include <utility>

#include "core/base/stop.h"
#include "core/geometry/surface_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

// The next word of a line; empty at its end.
std::string_view Word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
  line.remove_prefix(begin);
  const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
  line.remove_prefix(word.size());
  return word;
}

// The bytes up to a line break (LF, CR LF or CR), which is removed with them.
std::string_view TakePhysicalLine(std::string_view& bytes) {
  const std::size_t end = std::min(bytes.find_first_of("\r\n"), bytes.size());
  const std::string_view line = bytes.substr(0, end);
  const std::size_t length = bytes.substr(end).starts_with("\r\n") ? 2 : 1;
  bytes.remove_prefix(std::min(end + length, bytes.size()));
  return line;
}

class ObjReader {
 public:
  ObjReader(const std::stop_token& stop, Problems& problems) : stop_(stop), problems_(problems) {}

  RawSurface Read(std::string_view bytes) {
    while (!bytes.empty() && !failed_) {
      ThrowIfStopped(stop_);
      ++line_;
      const std::string_view line = TakeLine(bytes);
      ReadLine(line.substr(0, line.find('#')));
    }
    return std::move(raw_);
  }

 private:
  // The next line. A line that ends with a backslash continues on the next one.
  std::string_view TakeLine(std::string_view& bytes) {
    std::string_view line = TakePhysicalLine(bytes);
    if (!line.ends_with('\\')) return line;
    joined_.clear();
    while (line.ends_with('\\') && !bytes.empty()) {
      joined_.append(line.substr(0, line.size() - 1)) += ' ';
      line = TakePhysicalLine(bytes);
      ++line_;
    }
    return joined_ += line;
  }

  void Fail(const std::string& message) {
    problems_.Add("", "line " + std::to_string(line_) + ": " + message, "is the file complete?");
    failed_ = true;
  }

  void ReadLine(std::string_view line) {
    const std::string_view keyword = Word(line);
    if (keyword == "v") ReadNode(line);
    if (keyword == "f") ReadFace(line);
  }

  void ReadNode(std::string_view line) {
    Vec3 node;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = Word(line);
      if (!ParseDouble(word, node[axis])) return Fail("expected a coordinate but found " + Quoted(word));
    }
    raw_.nodes.push_back(node);
  }

  // Corners are node/texture/normal. Nodes count from 1, or backwards from the last one if negative.
  void ReadFace(std::string_view line) {
    std::vector<std::int64_t> polygon;
    for (std::string_view word = Word(line); !word.empty(); word = Word(line)) {
      std::int64_t number = 0;
      if (!ParseInt(word.substr(0, word.find('/')), number) || number == 0) {
        return Fail("expected a node number but found " + Quoted(word));
      }
      polygon.push_back(number > 0 ? number - 1 : static_cast<std::int64_t>(raw_.nodes.size()) + number);
    }
    if (polygon.size() < 3) return Fail("a face of " + std::to_string(polygon.size()) + " nodes");
    raw_.polygons.push_back(std::move(polygon));
  }

  const std::stop_token& stop_;
  Problems& problems_;
  int line_ = 0;
  bool failed_ = false;
  std::string joined_;  // a continued line
  RawSurface raw_;
};

}  // namespace

RawSurface ReadObj(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  return ObjReader(stop, problems).Read(bytes);
}

}  // namespace fascicle
