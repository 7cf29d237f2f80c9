// SPDX-License-Identifier: MIT
#include "scenes/read_scene_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <unordered_map>
#include <unordered_set>

#include "scenes/assemble.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/json_document.h"
#include "scenes/json_settings.h"
#include "scenes/json_shapes.h"
#include "scenes/json_transform.h"
#include "scenes/random.h"
#include "scenes/read.h"
#include "scenes/text_file.h"
#include "scenes/near_words.h"

namespace plumbline {
namespace {

constexpr std::size_t kDeepestParts = 64;                 // of parts within parts
constexpr std::uint64_t kMostWorldPrimitives = 1u << 27;  // more would fill 16 GB; nodes share geometry, the world not

/// One scene file while it is read.
struct File {
  JsonDocument document;
  std::filesystem::path folder;
  std::unordered_map<std::string, std::size_t> parts;  ///< member of "parts" by name
  std::vector<const Assembly*> part_of;                ///< of each member, once it has been read
  std::vector<bool> is_open;                           ///< of each member: being read
  std::unordered_map<const JsonValue*, const Assembly*> written_in_place;
  NamedMaterials materials;
};

/// Reads a scene file and what it names. Assemblies that are read stay: files and names share them.
class Reader {
 public:
  Scene read(const std::filesystem::path& path, std::string&& text) {
    Settings settings;
    open_files_.push_back(identity(path));
    Assembly root = read_file(path, std::move(text), &settings);
    const std::vector<std::size_t> lines = std::move(root.lines);
    Scene scene = pool_.finish(std::move(root));
    if (placed_count(scene) == 0)
      throw InputError(path.string(), 1, "nothing to trace: no triangle or sphere is placed by 'world' or 'nodes'");
    check_composed(path.string(), scene, lines);
    apply(settings, scene);
    scene.warnings = std::move(warnings_);
    return scene;
  }

 private:
  static std::string identity(const std::filesystem::path& path) {
    std::error_code failure;
    const auto canonical = std::filesystem::weakly_canonical(path, failure);
    return (failure ? path : canonical).string();
  }

  /// `settings` is null for a file that is a part: only the outermost file's count.
  Assembly read_file(const std::filesystem::path& path, std::string&& text, Settings* settings) {
    File file;
    file.document = parse_json(path.string(), text);
    file.folder = path.parent_path();
    const JsonPlace root(file.document);
    root.allow({"$schema", "description", "background", "camera", "lights", "effects", "ground", "materials", "parts",
                "world", "nodes"});
    Settings ignored;
    if (settings == nullptr) settings = &ignored;
    read_settings(root, *settings);
    if (const auto materials = root.find("materials")) file.materials = read_materials(*materials, file.folder, pool_);
    if (const auto ground = root.find("ground"); ground) settings->ground = read_ground(*ground, file.materials, pool_);

    if (const auto parts = root.find("parts")) {
      parts->check_object();
      for (std::size_t i = 0; i < parts->size(); ++i) file.parts.emplace(parts->key(i), i);
      file.part_of.resize(parts->size(), nullptr);
      file.is_open.resize(parts->size(), false);
      for (std::size_t i = 0; i < parts->size(); ++i) named_part(file, *parts, i);
    }

    Assembly assembly;
    std::unordered_set<std::string> names;
    if (const auto world = root.find("world")) {
      world->check_array();
      std::vector<std::uint32_t> meshes;
      std::uint64_t count = 0;
      for (std::size_t i = 0; i < world->size(); ++i) {
        const JsonPlace place = world->at(i);
        const Assembly& part = part_at(file, place);
        if (part.mesh != kNone) {
          count += pool_.primitive_count(part.mesh);
          if (count > kMostWorldPrimitives)
            place.fail("the world holds more than " + std::to_string(kMostWorldPrimitives) +
                       " triangles and spheres; place parts by nodes, which share them");
          meshes.push_back(part.mesh);
        }
        place_nodes(place, assembly, kNone, part, names);
      }
      assembly.mesh = pool_.joined(meshes, path.stem().string());
    }
    if (const auto nodes = root.find("nodes")) read_nodes(file, *nodes, assembly, kNone, names);
    return assembly;
  }

  // --- Parts ---------------------------------------------------------------------------------------------------------

  const Assembly& named_part(File& file, const JsonPlace& parts, std::size_t i) {
    if (file.part_of[i] != nullptr) return *file.part_of[i];
    const JsonPlace place = parts.at(i);
    if (file.is_open[i]) place.fail("this part holds itself");
    file.is_open[i] = true;
    file.part_of[i] = &read_part(file, place, parts.key(i));
    file.is_open[i] = false;
    return *file.part_of[i];
  }

  /// What a node or the world names: the name of a part, or a part written in place.
  const Assembly& part_at(File& file, const JsonPlace& place) {
    if (!place.is_string()) {
      // Children of a repeated node are read once for each copy; their parts are shared all the same.
      const auto known = file.written_in_place.find(&place.value());
      if (known != file.written_in_place.end()) return *known->second;
      return *(file.written_in_place[&place.value()] = &read_part(file, place, "part"));
    }
    const auto found = file.parts.find(place.text());
    if (found != file.parts.end()) return named_part(file, JsonPlace(file.document).need("parts"), found->second);
    std::vector<std::string> names;
    for (const auto& [name, member] : file.parts) names.push_back(name);
    std::sort(names.begin(), names.end());
    place.fail("no part is called " + shown(place.text()) + did_you_mean(place.text(), names) +
               "; name it in 'parts', or write {\"source\": ...} for a file or a generator");
  }

  /// A part: a source as a string, or an object of a source, shapes or nodes, and a material.
  const Assembly& read_part(File& file, const JsonPlace& place, const std::string& name) {
    if (++depth_ > kDeepestParts)
      place.fail("parts within parts are deeper than " + std::to_string(kDeepestParts) + " levels");
    const Assembly* result = nullptr;
    if (place.is_string()) {
      result = &read_source(file, place);
    } else {
      if (!place.is_object()) place.fail("expected a source as a string, or an object");
      place.allow(
          {"source", "spheres", "discs", "positions", "normals", "texcoords", "triangles", "nodes", "material"});
      const auto source = place.find("source"), nodes = place.find("nodes");
      const auto material = place.find("material");
      const std::uint32_t replacement = material ? find_material(file.materials, *material) : kNone;
      const bool has_shapes = place.find("spheres") || place.find("discs") || place.find("positions") ||
                              place.find("triangles") || place.find("normals") || place.find("texcoords");
      if ((source ? 1 : 0) + (nodes ? 1 : 0) + (has_shapes ? 1 : 0) != 1)
        place.fail(
            "a part has either 'source', or 'nodes', or shapes: 'spheres', 'discs', 'positions' and 'triangles'");
      if (source) {
        result = &read_source(file, *source);
        if (replacement != kNone) result = &with_material(*result, replacement);
      } else if (nodes) {
        if (replacement != kNone) material->fail("nodes have no material; give it to the parts that they place");
        Assembly assembly;
        std::unordered_set<std::string> names;
        read_nodes(file, *nodes, assembly, kNone, names);
        if (assembly.nodes.empty()) nodes->fail("a part must not be empty");
        result = &keep(std::move(assembly));
      } else {
        Scene shapes = read_shapes(place, file.materials, replacement, pool_);
        shapes.name = name;
        Assembly assembly;
        assembly.mesh = pool_.add_mesh(std::move(shapes));
        result = &keep(std::move(assembly));
      }
    }
    --depth_;
    return *result;
  }

  /// A generator, or a file relative to the one that names it.
  const Assembly& read_source(const File& file, const JsonPlace& place) {
    const std::string& spec = place.text();
    const std::string_view generator = std::string_view(spec).substr(0, spec.find(':'));
    const bool is_generated = std::any_of(generators().begin(), generators().end(),
                                          [&](const Generator& known) { return known.name == generator; });
    if (is_generated) {
      const auto known = sources_.find(spec);
      if (known != sources_.end()) return *known->second;
      try {
        return *(sources_[spec] = &keep(pool_.add_scene(load_scene(spec), warnings_)));
      } catch (const InputError& error) {
        place.fail(error.what());
      }
    }
    const std::filesystem::path path = file.folder / spec;
    std::error_code failure;
    if (spec.empty() || !std::filesystem::exists(path, failure))
      place.fail("no such file: " + shown(path.string(), 200) +
                 "; paths are relative to this file, and generators are as in \"sphereflake:3\"");
    const std::string key = identity(path);
    if (std::find(open_files_.begin(), open_files_.end(), key) != open_files_.end())
      place.fail("a cycle: this file is being read already and would hold itself");
    const auto known = sources_.find(key);
    if (known != sources_.end()) return *known->second;
    if (open_files_.size() >= kDeepestParts)
      place.fail("scene files within scene files are deeper than " + std::to_string(kDeepestParts) + " levels");
    const Assembly* result = nullptr;
    if (path.extension() == ".json") {
      open_files_.push_back(key);
      Assembly assembly = read_file(path, read_text_file(path), nullptr);
      open_files_.pop_back();
      if (assembly.is_empty()) place.fail("this scene file places nothing");
      result = &keep(std::move(assembly));
    } else {
      result = &keep(pool_.add_scene(read_scene(path), warnings_));
    }
    return *(sources_[key] = result);
  }

  const Assembly& with_material(const Assembly& assembly, std::uint32_t material) {
    const auto key = std::pair(&assembly, material);
    const auto known = overridden_.find(key);
    if (known != overridden_.end()) return *known->second;
    return *(overridden_[key] = &keep(pool_.with_material(assembly, material)));
  }

  const Assembly& keep(Assembly&& assembly) {
    kept_.push_back(std::make_unique<Assembly>(std::move(assembly)));
    return *kept_.back();
  }

  // --- Nodes ---------------------------------------------------------------------------------------------------------

  void read_nodes(File& file, const JsonPlace& nodes, Assembly& into, std::uint32_t parent,
                  std::unordered_set<std::string>& names) {
    nodes.check_array();
    for (std::size_t i = 0; i < nodes.size(); ++i) read_node(file, nodes.at(i), i, into, parent, names);
  }

  void read_node(File& file, const JsonPlace& place, std::size_t index, Assembly& into, std::uint32_t parent,
                 std::unordered_set<std::string>& names) {
    place.allow({"name", "part", "transform", "keyframes", "repeat", "jitter", "children"});
    const auto part_place = place.find("part"), transform_place = place.find("transform"),
               keyframes = place.find("keyframes"), children = place.find("children");
    const std::string name = node_name(place, part_place, index);
    const FileTransform own = transform_place ? read_transform(*transform_place) : FileTransform{};
    const Assembly* const part = part_place ? &part_at(file, *part_place) : nullptr;
    const auto copies = read_copies(place, own.matrix, kMostNodes);
    if (copies && keyframes) keyframes->fail("a repeated node has no keyframes; put them on a child of it");

    const std::size_t count = copies ? copies->size() : 1;
    for (std::size_t copy = 0; copy < count; ++copy) {
      Node node;
      node.name = copies ? name + "." + std::to_string(copy) : name;
      if (copies) {
        node.transform = rounded(place, (*copies)[copy]);
      } else if (transform_place) {
        node.transform = rounded(*transform_place, own.matrix);
      }
      const std::uint32_t number = add_node(place, into, parent, std::move(node), names);
      if (keyframes) {
        Animation animation = read_keyframes(*keyframes, own);
        animation.node = number;
        into.nodes[number].transform = transform_at(animation, 0.0);
        into.animation.push_back(std::move(animation));
      }
      into.nodes[number].rest = into.nodes[number].transform;
      if (part != nullptr && part->nodes.empty() && !children) {
        into.nodes[number].part = part->mesh;
        continue;
      }
      // A node holds geometry or nodes: what would hold both has its geometry on a node of its own.
      if (part != nullptr && part->mesh != kNone) {
        Node geometry;
        geometry.name = "geometry";
        geometry.part = part->mesh;
        add_node(place, into, number, std::move(geometry), names);
      }
      if (part != nullptr) place_nodes(place, into, number, *part, names);
      if (children) read_nodes(file, *children, into, number, names);
    }
  }

  static std::string node_name(const JsonPlace& place, const std::optional<JsonPlace>& part, std::size_t index) {
    if (const auto name = place.find("name")) {
      const std::string& text = name->text();
      if (text.empty() || text.find('/') != text.npos) name->fail("a name must not be empty, nor hold a '/'");
      return text;
    }
    return (part && part->is_string() ? part->text() : "node") + "." + std::to_string(index);
  }

  /// `node` has its name below its parent.
  std::uint32_t add_node(const JsonPlace& place, Assembly& into, std::uint32_t parent, Node&& node,
                         std::unordered_set<std::string>& names) {
    reserve_nodes(place, into, 1);
    node.parent = parent;
    if (parent != kNone) node.name = into.nodes[parent].name + "/" + node.name;
    if (!names.insert(node.name).second)
      place.fail("there is another node " + shown(node.name, 100) + "; give it a name of its own");
    into.nodes.push_back(std::move(node));
    into.lines.push_back(place.line());
    return static_cast<std::uint32_t>(into.nodes.size() - 1);
  }

  void place_nodes(const JsonPlace& place, Assembly& into, std::uint32_t parent, const Assembly& part,
                   std::unordered_set<std::string>& names) {
    reserve_nodes(place, into, part.nodes.size());
    const std::size_t first = into.nodes.size();
    add_nodes(into, parent, part, place.line());
    for (std::size_t n = first; n < into.nodes.size(); ++n) {
      if (!names.insert(into.nodes[n].name).second)
        place.fail("there is another node " + shown(into.nodes[n].name, 100) + "; give it a name of its own");
    }
  }

  /// Parts within parts may double at each level: what is kept of them counts too.
  void reserve_nodes(const JsonPlace& place, const Assembly& into, std::size_t count) {
    total_nodes_ += count;
    if (into.nodes.size() + count > kMostNodes || total_nodes_ > 4 * std::size_t{kMostNodes})
      place.fail("the scene has more than " + std::to_string(kMostNodes) + " nodes");
  }

  MeshPool pool_;
  std::vector<std::string> warnings_;
  std::vector<std::string> open_files_;  ///< from the outermost
  std::size_t depth_ = 0, total_nodes_ = 0;
  std::vector<std::unique_ptr<Assembly>> kept_;
  std::unordered_map<std::string, const Assembly*> sources_;
  std::map<std::pair<const Assembly*, std::uint32_t>, const Assembly*> overridden_;
};

}  // namespace

Scene read_scene_file(const std::filesystem::path& path, std::string&& text) {
  return Reader().read(path, std::move(text));
}

}  // namespace plumbline
