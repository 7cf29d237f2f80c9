// SPDX-License-Identifier: MIT
// The reader of glTF 2.0 files: nodes, instances of meshes, cameras, point lights and the animation of transforms.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_set>

#include "scenes/assemble.h"
#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/gltf_data.h"
#include "scenes/gltf_mesh.h"
#include "scenes/json_transform.h"
#include "scenes/read_formats.h"
#include "scenes/read_scene_file.h"
#include "scenes/text_file.h"

namespace plumbline {
namespace {

constexpr double kPi = 3.141592653589793;

glm::dvec4 read_four(const JsonPlace& place) {
  place.check_array(4, 4);
  return {place.at(0).number(), place.at(1).number(), place.at(2).number(), place.at(3).number()};
}

glm::dquat unit_quaternion(const JsonPlace& place, const glm::dvec4& xyzw) {
  const glm::dvec4 size = glm::abs(xyzw);
  const double largest = std::max({size.x, size.y, size.z, size.w});
  if (!(largest > 0.0)) place.fail("a quaternion must not be zero");
  const glm::dvec4 q = xyzw / largest;
  return glm::normalize(glm::dquat(q.w, q.x, q.y, q.z));
}

class GltfReader {
 public:
  GltfReader(const std::filesystem::path& path, const std::string& content)
      : file_(path.string()), data_(read_gltf_data(path, content)), root_(data_.document), meshes_(data_, scene_) {}

  Scene read() {
    check_extensions();
    const auto nodes = root_.find("nodes"), meshes = root_.find("meshes");
    node_count_ = nodes ? nodes->size() : 0;
    number_of_.assign(node_count_, kNone);
    if (meshes) part_of_.assign(meshes->size(), kUnread);
    read_nodes();
    read_animations();
    check_composed(file_, scene_, lines_);
    meshes_.report(root_);
    if (skinned_ > 0) warn("skins are not read: " + std::to_string(skinned_) + " nodes stand in their pose at rest");
    read_cameras();
    read_lights();
    return std::move(scene_);
  }

 private:
  static constexpr std::uint32_t kUnread = kNone - 1;

  void warn(const std::string& message) { scene_.warnings.push_back(root_.message(message)); }

  void check_extensions() {
    // Those that add nothing that is traced, or that are read.
    static const std::set<std::string> kHarmless = {"KHR_lights_punctual", "KHR_mesh_quantization",
                                                    "KHR_materials_unlit", "KHR_materials_specular",
                                                    "KHR_materials_ior"};
    if (const auto required = root_.find("extensionsRequired")) {
      required->check_array();
      for (std::size_t i = 0; i < required->size(); ++i) {
        if (!kHarmless.contains(required->at(i).text()))
          required->at(i).fail("the file needs the extension " + shown(required->at(i).text()) +
                               ", which is not read; export it without");
      }
    }
  }

  // --- Nodes ---------------------------------------------------------------------------------------------------------

  /// The nodes of the scene that the file shows first; those without a parent where it has none.
  std::vector<JsonPlace> root_nodes(const JsonPlace& nodes) {
    std::vector<JsonPlace> roots;
    const auto scenes = root_.find("scenes"), chosen = root_.find("scene");
    const std::size_t scene_count = scenes ? scenes->size() : 0;
    if (scene_count > 0) {
      const JsonPlace scene = scenes->at(chosen ? gltf_index(*chosen, scene_count, "scenes") : 0);
      if (scene_count > 1) warn("of several scenes one is read");
      const auto list = scene.find("nodes");
      if (list) list->check_array();
      for (std::size_t i = 0; list && i < list->size(); ++i) roots.push_back(list->at(i));
      return roots;
    }
    std::vector<bool> has_parent(node_count_, false);
    for (std::size_t n = 0; n < node_count_; ++n) {
      const auto children = nodes.at(n).find("children");
      if (children) children->check_array();
      for (std::size_t i = 0; children && i < children->size(); ++i)
        has_parent[gltf_index(children->at(i), node_count_, "nodes")] = true;
    }
    for (std::size_t n = 0; n < node_count_; ++n) {
      if (!has_parent[n]) roots.push_back(nodes.at(n));
    }
    return roots;
  }

  void read_nodes() {
    const auto nodes = root_.find("nodes");
    if (!nodes) return;
    struct Waiting {
      std::uint32_t node, parent;
      JsonPlace named_at;
    };
    std::vector<Waiting> waiting;
    for (const JsonPlace& root : root_nodes(*nodes)) {
      // A root is named by its number, or is the node itself.
      const std::uint32_t n = root.is_object() ? static_cast<std::uint32_t>(&root.value() - nodes->value().items.data())
                                               : gltf_index(root, node_count_, "nodes");
      waiting.push_back({n, kNone, root});
    }
    std::reverse(waiting.begin(), waiting.end());
    while (!waiting.empty()) {
      const Waiting next = waiting.back();
      waiting.pop_back();
      if (number_of_[next.node] != kNone)
        next.named_at.fail("node " + std::to_string(next.node) +
                           " is reached twice: a cycle, or a node with two parents");
      const std::uint32_t number = add_node(nodes->at(next.node), next.node, next.parent);
      const auto children = nodes->at(next.node).find("children");
      if (children) children->check_array();
      for (std::size_t i = children ? children->size() : 0; i-- > 0;)
        waiting.push_back({gltf_index(children->at(i), node_count_, "nodes"), number, children->at(i)});
    }
  }

  std::uint32_t add_node(const JsonPlace& place, std::uint32_t index, std::uint32_t parent) {
    if (scene_.nodes.size() + 2 > kMostNodes)
      place.fail("the scene has more than " + std::to_string(kMostNodes) + " nodes");
    Node node;
    node.parent = parent;
    node.transform = rounded(place, read_own_transform(place, index).matrix);
    node.rest = node.transform;
    std::string name = "node." + std::to_string(index);
    if (const auto named = place.find("name"); named && !named->text().empty()) name = named->text();
    std::replace(name.begin(), name.end(), '/', '_');
    node.name = unique_name(parent, name, index);
    if (place.find("skin")) ++skinned_;
    const auto number = static_cast<std::uint32_t>(scene_.nodes.size());
    number_of_[index] = number;
    scene_.nodes.push_back(std::move(node));
    lines_.push_back(place.line());

    const auto mesh = place.find("mesh");
    const std::uint32_t part = mesh ? part_at(*mesh) : kNone;
    if (part == kNone) return number;
    const auto children = place.find("children");
    if (!children || children->size() == 0) {
      scene_.nodes[number].part = part;
      return number;
    }
    // A node holds geometry or nodes: its mesh goes to a node of its own.
    Node geometry;
    geometry.parent = number;
    geometry.part = part;
    geometry.name = unique_name(number, "geometry", index);
    scene_.nodes.push_back(std::move(geometry));
    lines_.push_back(place.line());
    return number;
  }

  std::string unique_name(std::uint32_t parent, const std::string& name, std::uint32_t index) {
    const std::string before = parent == kNone ? "" : scene_.nodes[parent].name + "/";
    std::string full = before + name;
    if (!names_.insert(full).second) {
      full += "." + std::to_string(index);
      while (!names_.insert(full).second) full += "'";
    }
    return full;
  }

  std::uint32_t part_at(const JsonPlace& place) {
    const auto meshes = root_.find("meshes");
    const std::uint32_t mesh = gltf_index(place, part_of_.size(), "meshes");
    if (part_of_[mesh] == kUnread) {
      const auto named = meshes->at(mesh).find("name");
      part_of_[mesh] = meshes_.add_part(meshes->at(mesh), named ? named->text() : "mesh." + std::to_string(mesh));
    }
    return part_of_[mesh];
  }

  /// As the file has it; kept for the animation.
  FileTransform read_own_transform(const JsonPlace& place, std::uint32_t index) {
    FileTransform own;
    if (const auto matrix = place.find("matrix")) {
      matrix->check_array(16, 16);
      own.is_simple = false;
      for (std::size_t i = 0; i < 16; ++i) {
        const double value = matrix->at(i).number();
        const auto column = static_cast<glm::length_t>(i / 4), row = static_cast<glm::length_t>(i % 4);
        if (row == 3) {
          if (value != (column == 3 ? 1.0 : 0.0)) matrix->at(i).fail("the last row must be 0 0 0 1");
        } else if (column == 3) {
          own.matrix.translation[row] = value;
        } else {
          own.matrix.linear[column][row] = value;
        }
      }
      rounded(*matrix, own.matrix);
    } else {
      if (const auto translation = place.find("translation")) own.translation = translation->vector();
      if (const auto rotation = place.find("rotation")) own.rotation = unit_quaternion(*rotation, read_four(*rotation));
      if (const auto scale = place.find("scale")) {
        own.scale = scale->vector();
        if (own.scale.x == 0.0 || own.scale.y == 0.0 || own.scale.z == 0.0)
          scale->fail("a scale of 0 makes the matrix singular");
      }
      own.matrix = {glm::mat3_cast(own.rotation), own.translation};
      for (glm::length_t axis = 0; axis < 3; ++axis) own.matrix.linear[axis] *= own.scale[axis];
    }
    if (own_.size() <= index) own_.resize(node_count_);
    own_[index] = own;
    return own;
  }

  // --- Animation -----------------------------------------------------------------------------------------------------

  void read_animations() {
    const auto animations = root_.find("animations");
    if (!animations) return;
    std::vector<std::uint32_t> animation_of(scene_.nodes.size(), kNone);
    std::set<std::pair<std::uint32_t, std::string>> seen;
    for (std::size_t i = 0; i < animations->size(); ++i) {
      const auto channels = animations->at(i).find("channels"), samplers = animations->at(i).find("samplers");
      if (!channels) continue;
      channels->check_array();
      if (samplers) samplers->check_array();
      for (std::size_t c = 0; c < channels->size(); ++c) {
        const JsonPlace target = channels->at(c).need("target"), path = target.need("path");
        const auto node_place = target.find("node");
        if (!node_place) continue;  // an extension's target
        const std::uint32_t node = gltf_index(*node_place, node_count_, "nodes");
        const JsonPlace sampler_place = channels->at(c).need("sampler");
        if (!samplers) sampler_place.fail("the animation has no samplers");
        const JsonPlace sampler = samplers->at(gltf_index(sampler_place, samplers->size(), "samplers"));
        if (path.text() == "weights") {
          ++other_channels_;
          continue;
        }
        if (path.text() != "translation" && path.text() != "rotation" && path.text() != "scale")
          path.fail("expected \"translation\", \"rotation\", \"scale\" or \"weights\"");
        if (number_of_[node] == kNone) continue;  // of another scene
        if (!seen.insert({node, path.text()}).second) {
          ++repeated_channels_;
          continue;
        }
        if (!own_[node].is_simple) path.fail("an animated node must not have a matrix");
        std::uint32_t& number = animation_of[number_of_[node]];
        if (number == kNone) {
          number = static_cast<std::uint32_t>(scene_.animation.size());
          Animation animation;
          animation.node = number_of_[node];
          animation.rest_translation = own_[node].translation;
          animation.rest_rotation = own_[node].rotation;
          animation.rest_scale = own_[node].scale;
          scene_.animation.push_back(animation);
        }
        read_channel(sampler, path.text(), scene_.animation[number]);
      }
    }
    if (other_channels_ > 0) warn("animated weights of morph targets are not read");
    if (repeated_channels_ > 0) warn("where several animations move the same, the first counts");
    if (cubic_ > 0) warn("CUBICSPLINE: transforms go straight from keyframe to keyframe");
    for (const Animation& animation : scene_.animation) {
      Node& node = scene_.nodes[animation.node];
      node.transform = node.rest = checked(animation, 0.0);
      const auto check_all = [&](const auto& keys) {
        for (const auto& key : keys) checked(animation, key.time);
      };
      check_all(animation.translation);
      check_all(animation.rotation);
      check_all(animation.scale);
    }
  }

  Transform checked(const Animation& animation, double time) const {
    const Transform transform = transform_at(animation, time);
    const std::string problem = transform_error(transform);
    if (!problem.empty())
      throw InputError(
          file_, lines_[animation.node],
          "node " + shown(scene_.nodes[animation.node].name, 100) + ": its animated matrix " + problem + " in 32 bits");
    return transform;
  }

  void read_channel(const JsonPlace& sampler, const std::string& path, Animation& animation) {
    const bool is_rotation = path == "rotation";
    const JsonPlace input = sampler.need("input"), output = sampler.need("output");
    const GltfValues times = read_accessor(data_, input, "SCALAR");
    const GltfValues values = read_accessor(data_, output, is_rotation ? "VEC4" : "VEC3");
    const auto interpolation = sampler.find("interpolation");
    const std::string how = interpolation ? interpolation->text() : "LINEAR";
    if (how != "LINEAR" && how != "STEP" && how != "CUBICSPLINE")
      interpolation->fail("expected \"LINEAR\", \"STEP\" or \"CUBICSPLINE\"");
    // A spline has a tangent before each value and one behind it.
    const std::size_t each = how == "CUBICSPLINE" ? 3 : 1, middle = each / 2;
    if (each == 3) ++cubic_;
    if (values.count != each * times.count)
      output.fail("expected " + std::to_string(each * times.count) + " values for " + std::to_string(times.count) +
                  " times, found " + std::to_string(values.count));
    for (std::size_t i = 0; i < times.count; ++i) {
      if (i > 0 && !(times.at(i) > times.at(i - 1))) input.fail("the times of keyframes must ascend");
    }
    const auto add = [&](auto& keys, const auto& value_at) {
      for (std::size_t i = 0; i < times.count; ++i) {
        // A step is two keyframes at neighbouring times: the value before holds up to the last double before the next.
        if (how == "STEP" && i > 0)
          keys.push_back({std::nextafter(times.at(i), -std::numeric_limits<double>::infinity()), keys.back().value});
        keys.push_back({times.at(i), value_at(each * i + middle)});
      }
    };
    const auto vector_at = [&](std::size_t i) { return glm::dvec3(values.at(i, 0), values.at(i, 1), values.at(i, 2)); };
    if (is_rotation) {
      add(animation.rotation, [&](std::size_t i) {
        return unit_quaternion(output, {values.at(i, 0), values.at(i, 1), values.at(i, 2), values.at(i, 3)});
      });
    } else if (path == "translation") {
      add(animation.translation, vector_at);
    } else {
      add(animation.scale, vector_at);
      for (std::size_t i = 1; i < animation.scale.size(); ++i) {
        for (glm::length_t axis = 0; axis < 3; ++axis) {
          if (animation.scale[i - 1].value[axis] * animation.scale[i].value[axis] < 0.0)
            output.fail("a scale that changes its sign from one keyframe to the next is singular between them");
        }
      }
    }
  }

  // --- Cameras and lights
  // ----------------------------------------------------------------------------------------------

  /// The nodes that have `key`, in the order of the scene's nodes.
  std::vector<std::pair<std::uint32_t, JsonPlace>> nodes_with(const char* key) {
    std::vector<std::pair<std::uint32_t, JsonPlace>> found;
    const auto nodes = root_.find("nodes");
    for (std::uint32_t n = 0; n < node_count_; ++n) {
      if (number_of_[n] == kNone) continue;
      if (const auto place = nodes->at(n).find(key)) found.emplace_back(number_of_[n], *place);
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return found;
  }

  void read_cameras() {
    frame_camera(scene_);
    const auto cameras = root_.find("cameras");
    const Ball ball = bounding_ball(scene_);
    for (const auto& [node, place] : nodes_with("camera")) {
      if (!cameras) place.fail("the file has no cameras");
      const JsonPlace camera = cameras->at(gltf_index(place, cameras->size(), "cameras"));
      if (camera.need("type").text() != "perspective") {
        warn("only perspective cameras are read");
        continue;
      }
      if (scene_.has_camera) {
        warn("of several cameras the first is read");
        break;
      }
      const JsonPlace perspective = camera.need("perspective"), yfov = perspective.need("yfov");
      const double field = yfov.number();
      if (!(field > 0.0 && field < kPi)) yfov.fail("expected an angle above 0 and below pi");
      double aspect = 1.0;
      if (const auto ratio = perspective.find("aspectRatio")) {
        aspect = ratio->number();
        if (!(aspect > 0.0)) ratio->fail("expected a number above 0");
      }
      const TransformD at = to_world(scene_, node);
      const glm::dvec3 forward = -glm::normalize(at.linear[2]);
      Camera& view = scene_.camera;
      view = Camera{};
      view.from = glm::vec3(at.translation);
      // As far as the middle of the scene, so that rounding `at` to floats turns the view least.
      const double distance = glm::length(ball.center - at.translation);
      view.at = glm::vec3(glm::dvec3(view.from) + forward * (distance > 0.0 ? distance : 1.0));
      view.up = glm::vec3(glm::normalize(at.linear[1]));
      view.height = 512;
      view.width = static_cast<int>(std::lround(std::clamp(512.0 * aspect, 1.0, 16384.0)));
      // glTF's angle spans the picture from edge to edge, a Camera's the centres of the outermost rows.
      const double rows = view.height;
      view.angle_radians = static_cast<float>(2.0 * std::atan(std::tan(0.5 * field) * (rows - 1.0) / rows));
      try {
        camera_frame(view);
      } catch (const InputError& error) {
        place.fail(error.what());
      }
      scene_.has_camera = true;
    }
  }

  void read_lights() {
    const auto extensions = root_.find("extensions");
    const auto punctual = extensions ? extensions->find("KHR_lights_punctual") : std::nullopt;
    const auto lights = punctual ? punctual->find("lights") : std::nullopt;
    if (lights) lights->check_array();
    const Ball ball = bounding_ball(scene_);
    for (const auto& [node, place] : nodes_with("extensions")) {
      const auto named = place.find("KHR_lights_punctual");
      if (!named) continue;
      if (!lights) named->fail("the file has no lights");
      const JsonPlace light = lights->at(gltf_index(named->need("light"), lights->size(), "lights"));
      const std::string& type = light.need("type").text();
      if (type != "point" && type != "spot") {
        warn("lights without a place (directional) are left out");
        continue;
      }
      if (type == "spot") warn("a spot light is read as a point that shines everywhere");
      double intensity = 1.0;
      if (const auto number = light.find("intensity")) intensity = number->number_between(0.0, 3e38);
      glm::dvec3 color(1.0);
      if (const auto given = light.find("color")) color = given->vector();
      Light added;
      added.position = glm::vec3(to_world(scene_, node).translation);
      // Lights do not fall off here, and a diffuse surface of glTF gives back a pi-th of what falls on it: the strength
      // is what reaches the middle of the scene.
      const glm::dvec3 way = glm::dvec3(added.position) - ball.center;
      const double squared = glm::dot(way, way);
      const glm::dvec3 strength = color * intensity / (kPi * (squared > 0.0 ? squared : 1.0));
      added.color = glm::vec3(glm::clamp(strength, glm::dvec3(0.0), glm::dvec3(std::numeric_limits<float>::max())));
      added.has_color = true;
      scene_.lights.push_back(added);
    }
  }

  const std::string file_;
  const GltfData data_;
  const JsonPlace root_;
  Scene scene_;
  GltfMeshes meshes_;
  std::size_t node_count_ = 0;
  std::vector<std::uint32_t> number_of_;  ///< in the scene, of each node of the file; kNone: not shown
  std::vector<std::uint32_t> part_of_;    ///< of each mesh
  std::vector<FileTransform> own_;        ///< of each node of the file that is shown
  std::vector<std::size_t> lines_;        ///< of each node of the scene
  std::unordered_set<std::string> names_;
  std::size_t skinned_ = 0, other_channels_ = 0, repeated_channels_ = 0, cubic_ = 0;
};

}  // namespace

Scene read_gltf(const std::filesystem::path& path, std::string&& content) { return GltfReader(path, content).read(); }

}  // namespace plumbline
