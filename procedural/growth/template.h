// Template: the right-hand side of a production, a mesh that takes the place of a face (the paper's section 4).
//
// A template's first face, the socket, is never written down: it is the replaced face itself. Its corners are the
// corners of that face, so the border is shared and neither T-vertices nor gaps can arise; the other faces hang on it
// and, with it, make a closed mesh (a leaf's blade alone is an open sheet). What grows is a pure function of the socket
// and of the evaluated parameters; how many vertices and faces, and which, depends on the number of corners alone, save
// for a rotation of the corners.
//
// A new template is one file in procedural/growth/templates: a class whose constructor reads its parameters from
// TemplateParams, and its register_<file>(TemplateRegistry&). Immutable after construction: any thread may grow it.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/base/registry.h"
#include "geometry/cells/step.h"
#include "geometry/fields/expression.h"
#include "geometry/mesh/mesh.h"
#include "procedural/growth/named_faces.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meristem {

// The face that is replaced, and the values of the template's parameters there.
struct Socket {
  std::span<const Vec3d> corners;  // counter-clockwise seen from outside
  std::span<const Vec2d> uv;       // one a corner
  FaceFrame frame;
  std::span<const Vec3d> values;  // by the slots that TemplateParams gave; scalars in x

  std::uint32_t count() const { return std::uint32_t(corners.size()); }
  Vec3d offset(std::uint32_t corner) const { return corners[corner] - frame.origin; }
  double scalar(int slot) const { return values[std::size_t(slot)].x; }
  Vec3d vector(int slot) const { return values[std::size_t(slot)]; }
};

// What is known of many sockets at once.
struct SocketRange {
  double radius = 0;                 // no corner is further than this from its face's centroid
  Interval u, v;                     // of the corners
  std::span<const Bounds3d> values;  // by slot; scalars in x

  // The largest absolute value of a scalar parameter.
  double largest(int slot) const {
    const Bounds3d& b = values[std::size_t(slot)];
    return std::max(std::abs(b.lower.x), std::abs(b.upper.x));
  }
};

// Bounds on what grows on any socket of a range.
struct Reach {
  double distance = 0;  // of a new vertex from the centroid of the replaced face
  double edge = 0;      // the longest edge of a new quadrilateral, or distance of two corners of another face
  std::vector<double> face_radius;  // by name: the largest distance of a corner of such a face from its centroid
  Interval u, v;
};

// One kind of face of a template. A production that says nothing of this name uses what it says of the group.
struct FaceName {
  std::string name;
  int group = -1;  // index of another name; -1: none
};

class Template {
 public:
  virtual ~Template() = default;
  virtual const std::vector<FaceName>& face_names() const = 0;
  // Why it cannot grow on a face with so many corners, or an empty text.
  virtual std::string refusal(std::uint32_t corners) const {
    (void)corners;
    return {};
  }
  // Adds vertices and faces to `out`, which has been cleared for the socket's border.
  virtual void grow(const Socket& socket, NamedFaces& out) const = 0;
  virtual Reach bound(const SocketRange& range) const = 0;
};

// One expression of a template, evaluated for every socket and clamped to its range (not a number counts as the value
// nearest 0), so that grow() gets finite numbers in known ranges whatever the user wrote.
struct TemplateParameter {
  std::shared_ptr<const Expression> expression;  // null after an error
  Range range;

  Vec3d evaluate(std::span<const Vec3f> variables, Key key, Key salt) const;
  Bounds3d bounds(std::span<const IntervalValue> variables) const;
};

// Where a template may ask for files: a folder with the scene's assets.
struct TemplateFiles {
  std::string folder;
};

// How a template reads its parameters: expressions over the variables of the rule (by slot), and plain ones.
class TemplateParams {
 public:
  TemplateParams(Params& params, const Symbols& variables, const TemplateFiles& files)
      : params_(params), variables_(variables), files_(files) {}

  // An expression; returns its slot in Socket::values.
  int number(const char* name, const char* fallback, Range range, const char* doc);
  int vector(const char* name, const char* fallback, Range range, const char* doc);
  // What is the same for all sockets: choices, lists, file names.
  Params& plain() { return params_; }
  const TemplateFiles& files() const { return files_; }

  std::vector<TemplateParameter> take() { return std::move(parameters_); }

 private:
  Params& params_;
  const Symbols& variables_;
  const TemplateFiles& files_;
  std::vector<TemplateParameter> parameters_;
};

// A template together with the expressions for its parameters.
struct BoundTemplate {
  std::unique_ptr<Template> shape;
  std::vector<TemplateParameter> parameters;
};

// The templates by name. Filled once at start-up, then read-only.
class TemplateRegistry {
 public:
  template <class T>
  void add(const char* name, const char* doc) {
    entries_.push_back(
        {name, doc, [](TemplateParams& params) -> std::unique_ptr<Template> { return std::make_unique<T>(params); }});
  }
  std::vector<std::string> names() const;
  std::vector<ComponentInfo> infos() const;  // of kind "template"
  // Reads the template's parameters from the production in `params`. The name must be known.
  BoundTemplate create(const std::string& name, Params& params, const Symbols& variables,
                       const TemplateFiles& files) const;

 private:
  struct Entry {
    std::string name;
    std::string doc;
    std::function<std::unique_ptr<Template>(TemplateParams&)> make;
  };
  std::vector<Entry> entries_;
};

// What the template makes of a regular polygon of that many corners with the parameters nearest to 1 in their ranges:
// a sample of its structure (numbers of faces and corners, names), which is the same for every socket.
NamedFaces sample_growth(const BoundTemplate& part, std::uint32_t corners);

}  // namespace meristem
