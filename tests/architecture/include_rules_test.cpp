// Every #include against the table of docs/architecture.md: an include only ever goes down.
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

struct RoomRule {
  std::set<std::string> rooms;   // project rooms it may include besides itself
  bool qt_core = false;          // QtCore headers
  bool qt_widgets = false;       // any Qt header
  bool vtk = false;
  bool opencv = true;
};

// The longest matching prefix of a file's path is its room.
const std::map<std::string, RoomRule>& rules() {
  static const std::map<std::string, RoomRule> table = {
      {"core", {{}, false, false, false, false}},
      {"vision", {{"core"}}},
      {"calibration", {{"core", "vision"}}},
      {"planning", {{"core", "vision"}}},
      {"hardware", {{"core", "vision"}}},
      {"hardware/drivers", {{"core", "vision", "hardware"}, true, true}},
      {"hardware/fault_proxy", {{"core", "hardware"}, true, true}},
      {"widgets/scene", {{"core", "vision", "planning"}, false, false, true}},
      {"widgets", {{"core", "vision", "planning", "widgets/scene"}, true, true, true}},
      {"session", {{"core", "vision", "planning", "calibration", "hardware", "hardware/drivers",
                    "hardware/fault_proxy"}, true}},
      {"session/document", {{"core", "vision", "planning"}}},
      {"session/commands", {{"core", "vision", "planning", "session/document"}}},
      {"session/tools", {{"core", "vision", "planning", "session/document", "session/commands"}}},
      {"ui", {{"core", "vision", "planning", "calibration", "hardware", "session", "session/document",
               "session/commands", "session/tools", "widgets", "widgets/scene"}, true, true, true}},
      {"app", {{"core", "vision", "planning", "calibration", "hardware", "hardware/drivers", "session",
                "session/document", "session/commands", "session/tools", "widgets", "widgets/scene", "ui"},
               true, true, true}},
      {"app/virtual_robot", {{"core", "vision", "planning", "hardware", "widgets/scene"}, true, true, true}},
  };
  return table;
}

// A room may use the rooms inside it: session includes session/tools, widgets includes widgets/scene.
std::string roomOf(const std::string& path) {
  std::string best;
  for (const auto& [room, rule] : rules()) {
    if (path.rfind(room + "/", 0) == 0 && room.size() > best.size()) best = room;
  }
  return best;
}

bool mayInclude(const std::string& from, const std::string& to) {
  if (to.empty() || from == to) return true;
  if (to.rfind(from + "/", 0) == 0) return true;
  return rules().at(from).rooms.count(to) != 0;
}

std::vector<std::string> includesOf(const fs::path& file) {
  std::vector<std::string> found;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto hash = line.find_first_not_of(" \t");
    if (hash == std::string::npos || line.compare(hash, 8, "#include") != 0) continue;
    const auto open = line.find_first_of("<\"", hash + 8);
    const auto close = open == std::string::npos ? open : line.find_first_of(">\"", open + 1);
    if (close != std::string::npos) found.push_back(line.substr(open, close - open));
  }
  return found;
}

std::string thirdPartyFault(const RoomRule& rule, const std::string& include) {
  const std::string name = include.substr(1);
  static const std::set<std::string> core_qt = {"QObject", "QString", "QTimer", "QtCore", "QCoreApplication",
      "QThread", "QProcess", "QPointer", "QVector", "QStringList", "QDir", "QFile", "QFileInfo", "QElapsedTimer",
      "QStandardPaths", "QSocketNotifier", "QVariant", "QMetaObject", "QThreadPool", "QRunnable", "QSettings",
      "QByteArray", "QEventLoop", "QMetaType", "QSaveFile", "QJsonDocument", "QJsonObject", "QJsonArray",
      "QAbstractListModel", "QLocale", "QUrl", "QProcessEnvironment", "QSignalSpy"};
  const bool qt = include[0] == '<' && name.size() > 1 && name[0] == 'Q' && std::isupper(name[1]) != 0;
  const bool qt_lower = include[0] == '<' && name.rfind("Qt", 0) == 0;
  const bool is_core_qt = core_qt.count(name.substr(0, name.find('/'))) != 0;
  if ((qt || qt_lower) && !rule.qt_widgets && !(rule.qt_core && is_core_qt)) return "Qt";
  if (name.rfind("vtk", 0) == 0 && include[0] == '<' && !rule.vtk) return "VTK";
  if (name.rfind("opencv2/", 0) == 0 && !rule.opencv) return "OpenCV";
  return "";
}

TEST(IncludeRules, EveryIncludeGoesDown) {
  const fs::path root = LONGARM_SOURCE_DIR;
  int files = 0;
  for (const char* top : {"app", "ui", "session", "widgets", "calibration", "planning", "hardware", "vision", "core"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const auto extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      ++files;
      const std::string path = fs::relative(entry.path(), root).string();
      const std::string room = roomOf(path);
      for (const auto& include : includesOf(entry.path())) {
        const std::string target = roomOf(include.substr(1));
        EXPECT_TRUE(mayInclude(room, target)) << path << " (" << room << ") includes " << include.substr(1)
                                              << " (" << target << "), which is not below it";
        const std::string fault = thirdPartyFault(rules().at(room), include);
        EXPECT_TRUE(fault.empty()) << path << ": " << room << " may not include " << fault << ": " << include.substr(1);
        if (include[0] == '"') {
          EXPECT_TRUE(fs::exists(root / include.substr(1))) << path << ": include \"" << include.substr(1)
                                                            << "\" by its full path from the root";
        }
      }
    }
  }
  EXPECT_GT(files, 20) << "the tree was not found at " << root;
}

TEST(IncludeRules, TheTestItselfSeesAViolation) {
  EXPECT_FALSE(mayInclude("vision", "planning"));
  EXPECT_FALSE(mayInclude("app/virtual_robot", "session"));
  EXPECT_TRUE(mayInclude("session", "session/tools"));
  EXPECT_EQ(thirdPartyFault(rules().at("planning"), "<QWidget"), "Qt");
  EXPECT_EQ(thirdPartyFault(rules().at("session"), "<QWidget"), "Qt");
  EXPECT_EQ(thirdPartyFault(rules().at("session"), "<QTimer"), "");
  EXPECT_EQ(thirdPartyFault(rules().at("vision"), "<vtkActor.h"), "VTK");
}

}  // namespace
