#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/mesh/triangle_mesh.h"

// Parts of mesh_file.cpp: one function for each format, points in the file's own unit.

namespace haptolith {

/// Reads words of a user's text and keeps its position.
class MeshText {
 public:
  /// @throws InvalidParameter for text in UTF-16. A byte order mark of UTF-8 is no part of the text.
  MeshText(std::string_view text, const std::string& name);

  /// The next word of this line; empty at its end, which is LF, CR LF or CR. A backslash at the end of a line joins the
  /// next one.
  [[nodiscard]] std::string_view wordOfLine();
  /// The next word, in whatever line; empty at the end of the text.
  [[nodiscard]] std::string_view word();
  /// Goes to the next line; false at the end of the text. @throws Failure when stopAsked().
  [[nodiscard]] bool nextLine();

  /// "spoon.obj:12: WHAT".
  [[nodiscard]] std::string place(std::string_view what) const;
  /// A coordinate. @throws InvalidParameter unless it is a finite number.
  [[nodiscard]] double number(std::string_view word, std::string_view what) const;

 private:
  void skipBlanks();
  void removeLineEnd();

  std::string_view rest_;
  const std::string& name_;
  int line_ = 1;
};

/// @throws InvalidParameter for one triangle or point more than there may be. @param place  "spoon.obj:12: face".
void requireRoom(const TriangleMesh& mesh, std::size_t points, std::size_t triangles, const std::string& place);

/// Sentences about what of a file was left out, or was unusual.
using MeshNotes = std::vector<std::string>;

[[nodiscard]] std::string_view withoutByteOrderMark(std::string_view bytes);

[[nodiscard]] TriangleMesh parseStl(std::string_view bytes, const std::string& name, MeshNotes& notes);
[[nodiscard]] TriangleMesh parseObj(std::string_view bytes, const std::string& name);
/// In m, z up.
[[nodiscard]] TriangleMesh parseGltf(std::string_view bytes, const std::string& name, MeshNotes& notes);

}  // namespace haptolith
