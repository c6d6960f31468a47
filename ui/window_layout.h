#pragma once

/// @file
/// WindowLayout: where panels stand, remembered from one run to the next.

#include <QByteArray>
#include <QMainWindow>
#include <QSettings>
#include <QSplitter>
#include <QString>
#include <functional>
#include <vector>

namespace longarm::ui {

/// A layout that cannot be used (other schema, damaged, off every screen) gives the factory layout.  GUI thread only.
class WindowLayout final {
 public:
  static constexpr int kSchema = 2;

  /// All borrowed; they outlive this.  What stands now is the factory layout.
  /// @param docks The window that holds the docks; @param window the one on the screen (may be the same).
  /// @param size Gives the docks their factory sizes; may be empty.
  WindowLayout(QMainWindow& window, QMainWindow& docks, std::vector<QSplitter*> splitters, QSettings& settings,
               std::function<void()> size = {});

  /// @returns false when there was nothing usable: the factory layout stands.
  bool restore();
  void save();
  void reset();
  /// The window stands on the screen: only now do docks take sizes.
  void shown();

 private:
  bool onScreen() const;

  QMainWindow& m_window;
  QMainWindow& m_docks;
  std::vector<QSplitter*> m_splitters;
  QSettings& m_settings;
  std::function<void()> m_size;
  bool m_is_factory = true;
  QByteArray m_factory;
  std::vector<QByteArray> m_factory_splitters;
};

}  // namespace longarm::ui
