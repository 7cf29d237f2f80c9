// SPDX-License-Identifier: MIT
// The reader of SPD's Neutral File Format (Haines 1987), by tokens: the keywords v b l f s c p pp, comments from # to
// the end of a line. What other programs added to the format is refused by name, but for a texture's name at the end of
// an f line.
#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/builder.h"
#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/read_formats.h"
#include "scenes/text_file.h"
#include "scenes/texture.h"

namespace plumbline {
namespace {

constexpr std::string_view kKnown = "known are v b l f s c p pp";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

/// One word and the line that it stands on; an empty word is the end of the file.
struct Token {
  std::string_view word;
  std::size_t line = 1;
};

class Tokens {
 public:
  explicit Tokens(std::string_view text) : rest_(text) { advance(); }

  const Token& peek() const { return current_; }
  Token take() {
    const Token token = current_;
    advance();
    return token;
  }

 private:
  void advance() {
    for (bool in_comment = false; !rest_.empty() && (in_comment || is_blank(rest_[0]) || rest_[0] == '#');) {
      if (rest_[0] == '#') in_comment = true;
      // CR LF is one end of a line, CR alone is one too.
      if (rest_[0] == '\n' || (rest_[0] == '\r' && !rest_.starts_with("\r\n"))) {
        in_comment = false;
        ++line_;
      }
      rest_.remove_prefix(1);
    }
    const auto end = static_cast<std::size_t>(std::find_if(rest_.begin(), rest_.end(), is_blank) - rest_.begin());
    current_ = {rest_.substr(0, end), line_};
    rest_.remove_prefix(end);
  }

  std::string_view rest_;
  std::size_t line_ = 1;
  Token current_;
};

class NffReader {
 public:
  NffReader(const std::filesystem::path& path, std::string_view text)
      : path_(path), name_(path.string()), tokens_(text) {}

  Scene read() {
    while (!tokens_.peek().word.empty()) read_statement();
    finish();
    return std::move(scene_);
  }

 private:
  void read_statement() {
    const Token keyword = tokens_.take();
    statement_line_ = keyword.line;
    if (keyword.word == "v") {
      read_view();
    } else if (keyword.word == "b") {
      scene_.background = vector("b (background colour)");
    } else if (keyword.word == "l") {
      read_light();
    } else if (keyword.word == "f") {
      read_material();
    } else if (keyword.word == "s") {
      read_sphere();
    } else if (keyword.word == "c") {
      read_cone();
    } else if (keyword.word == "p") {
      read_polygon(false);
    } else if (keyword.word == "pp") {
      read_polygon(true);
    } else if (parse_float(keyword.word)) {
      fail(keyword.line,
           "a stray number " + shown(keyword.word) + " where a keyword should be; " + std::string(kKnown));
    } else {
      fail(keyword.line, "unknown keyword " + shown(keyword.word) + "; " + std::string(kKnown));
    }
  }

  // --- Numbers -------------------------------------------------------------------------------------------------------

  [[noreturn]] void fail(std::size_t line, const std::string& message) const { throw InputError(name_, line, message); }

  float number(std::string_view what) {
    const Token token = tokens_.peek();
    if (token.word.empty()) {
      fail(statement_line_,
           std::string(what) + ": the file ends before its numbers do; it is cut short or they are missing");
    }
    const auto value = parse_float(token.word);
    if (!value) fail(token.line, std::string(what) + ": expected a finite number, found " + shown(token.word));
    last_number_line_ = tokens_.take().line;
    return *value;
  }

  glm::vec3 vector(std::string_view what) {
    const float x = number(what), y = number(what), z = number(what);
    return {x, y, z};
  }

  void word(std::string_view expected) {
    const Token token = tokens_.peek();
    if (token.word != expected) {
      fail(token.line, "v (viewpoint): expected '" + std::string(expected) + "', found " + shown(token.word));
    }
    tokens_.take();
  }

  int whole(std::string_view what, long long least, long long most) {
    const Token token = tokens_.peek();
    const auto value = parse_integer(token.word);
    if (!value || *value < least || *value > most) {
      fail(token.word.empty() ? statement_line_ : token.line,
           std::string(what) + ": expected a whole number of " + std::to_string(least) + " to " + std::to_string(most) +
               ", found " + shown(token.word));
    }
    tokens_.take();
    return static_cast<int>(*value);
  }

  // --- Statements ----------------------------------------------------------------------------------------------------

  void read_view() {
    Camera camera;
    word("from");
    camera.from = vector("from");
    word("at");
    camera.at = vector("at");
    word("up");
    camera.up = vector("up");
    word("angle");
    const float degrees = number("angle");
    if (!(degrees > 0.0f && degrees < 180.0f)) fail(statement_line_, "angle: must lie between 0 and 180 degrees");
    camera.angle_radians = static_cast<float>(degrees * (3.141592653589793 / 180.0));
    word("hither");
    camera.hither = number("hither");
    word("resolution");
    camera.width = whole("resolution", 1, 65536);
    camera.height = whole("resolution", 1, 65536);
    try {
      camera_frame(camera);
    } catch (const InputError& error) {
      fail(statement_line_, error.what());
    }
    if (scene_.has_camera) warn("a second viewpoint replaces the first");
    scene_.camera = camera;
    scene_.has_camera = true;
  }

  void read_light() {
    Light light;
    light.position = vector("l (light)");
    light.has_color = parse_float(tokens_.peek().word).has_value();
    if (light.has_color) light.color = vector("l (light colour)");
    scene_.lights.push_back(light);
  }

  void read_material() {
    Material material;
    material.color = vector("f (fill colour)");
    material.diffuse = number("f: Kd");
    material.specular = number("f: Ks");
    material.shine = number("f: Shine");
    material.transmittance = number("f: T");
    material.refraction_index = number("f: index of refraction");
    // Another program's extension: the name of a texture at the end of the line. Only a word with a dot can be one;
    // what else stands there is a keyword or a mistake.
    const Token next = tokens_.peek();
    if (next.line == last_number_line_ && next.word.find('.') != next.word.npos && !parse_float(next.word)) {
      tokens_.take();
      std::string problem;
      const auto texture = find_texture(scene_, path_.parent_path() / next.word, TextureKind::color, problem);
      if (texture) {
        material.diffuse_texture = *texture;
      } else {
        warn("the texture " + shown(next.word) + " is left out: " + problem);
      }
    }
    for (float* const factor : {&material.diffuse, &material.specular, &material.transmittance}) {
      if (*factor >= 0.0f && *factor <= 1.0f) continue;
      factor_out_of_range_.add(statement_line_);
      *factor = std::clamp(*factor, 0.0f, 1.0f);
    }
    add_material(scene_, material);
  }

  std::uint32_t material() {
    if (scene_.materials.empty()) {
      add_material(scene_, Material{});
      warn("no f statement stands before the first primitive: it gets a white matte surface");
    }
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
  }

  void read_sphere() {
    const std::uint32_t surface = material();
    const glm::vec3 center = vector("s (sphere)");
    const float radius = number("s (sphere)");
    if (radius < 0.0f) inward_sphere_.add(statement_line_);
    if (radius == 0.0f) {
      empty_sphere_.add(statement_line_);
      ++scene_.source.spheres;
    } else {
      add_sphere(scene_, center, std::abs(radius), surface);
    }
  }

  void read_cone() {
    const std::uint32_t surface = material();
    const glm::vec3 base = vector("c (cone or cylinder)");
    const float base_radius = number("c (cone or cylinder)");
    const glm::vec3 apex = vector("c (cone or cylinder)");
    const float apex_radius = number("c (cone or cylinder)");
    if (base_radius < 0.0f || apex_radius < 0.0f) inward_cone_.add(statement_line_);
    cone_.add(statement_line_);
    if (add_cone(scene_, base, std::abs(base_radius), apex, std::abs(apex_radius), surface) == Added::no_area) {
      empty_cone_.add(statement_line_);
    }
  }

  void read_polygon(bool has_normals) {
    const std::uint32_t surface = material();
    const std::string_view what = has_normals ? "pp (patch)" : "p (polygon)";
    // Corners are read one by one, so a number of corners that the file does not have costs no memory.
    const int count = whole(what, 3, 1'000'000'000);
    corners_.clear();
    normals_.clear();
    for (int i = 0; i < count; ++i) {
      corners_.push_back(vector(what));
      if (has_normals) normals_.push_back(vector(what));
    }
    switch (add_polygon(scene_, corners_, normals_, surface)) {
      case Added::whole:
        break;
      case Added::blended:
        crossing_.add(statement_line_);
        break;
      case Added::no_area:
        empty_polygon_.add(statement_line_);
        break;
      case Added::too_complex:
        fail(statement_line_,
             std::string(what) + ": too large, or its edges cross too often to be cut into triangles; split it");
    }
  }

  // --- What the user should know -------------------------------------------------------------------------------------

  void warn(const std::string& message) {
    scene_.warnings.push_back(name_ + ":" + std::to_string(statement_line_) + ": " + message);
  }

  void finish() {
    auto& warnings = scene_.warnings;
    cone_.report(
        warnings, name_,
        "cones and cylinders stand as open prisms of " + std::to_string(kConeSides) + " sides, 2 triangles each");
    empty_polygon_.report(warnings, name_, "a polygon without area is left out");
    empty_sphere_.report(warnings, name_, "a sphere of radius 0 is left out");
    empty_cone_.report(warnings, name_, "a cone or cylinder without area is left out");
    inward_sphere_.report(warnings, name_, "a negative radius means a sphere seen from inside: its sign is dropped");
    inward_cone_.report(warnings, name_, "a negative radius means a cone seen from inside: its sign is dropped");
    crossing_.report(warnings, name_, "a polygon crosses itself: all that it winds around is filled");
    factor_out_of_range_.report(warnings, name_,
                                "a factor of f lies outside 0 to 1 and is moved to the nearer of them");
    if (!scene_.has_camera) {
      warnings.push_back(name_ + ": no viewpoint: one is chosen that shows the whole scene");
      frame_camera(scene_);
    }
  }

  const std::filesystem::path& path_;
  const std::string name_;
  Tokens tokens_;
  Scene scene_;
  std::size_t statement_line_ = 1, last_number_line_ = 1;
  std::vector<glm::vec3> corners_, normals_;
  WarningTally cone_, empty_polygon_, empty_sphere_, empty_cone_, inward_sphere_, inward_cone_, crossing_,
      factor_out_of_range_;
};

}  // namespace

Scene read_nff(const std::filesystem::path& path, std::string&& text) { return NffReader(path, text).read(); }

}  // namespace plumbline
