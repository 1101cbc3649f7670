#pragma once
// The stages that a program knows, by the name that `stage:` gives.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace periost {

class Registry {
 public:
  struct Entry {
    std::unique_ptr<const Stage> stage;
    StageDeclaration declaration;
    std::string origin;  // "built in", or the file of the plugin
  };

  // Takes a stage. Throws Error{kUsage}: "plugin.duplicate_stage" when the name is taken,
  // "plugin.bad_declaration" when the declaration has a gap (a name that is not snake_case, a missing
  // sentence, a default out of range, a name given twice, a key called stage, id or from). On an error the
  // registry is unchanged.
  void add(std::unique_ptr<const Stage> stage);

  // The stage, or null.
  const Entry* find(const std::string& name) const;
  // Names in alphabetical order.
  std::vector<std::string> names() const;
  // The known name nearest to a misspelt one, or empty.
  std::string nearest(const std::string& name) const;

  // Where the stages of following add() calls come from; plugin loading sets it.
  void set_origin(std::string origin) { origin_ = std::move(origin); }
  const std::string& origin() const { return origin_; }
  // Moves all stages of another registry here, or none: throws as add().
  void merge(Registry&& other);

 private:
  std::map<std::string, Entry> entries_;
  std::string origin_ = "built in";
};

}  // namespace periost
