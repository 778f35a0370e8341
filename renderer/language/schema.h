// The JSON Schema (draft 7) of whole scene files, generated from the parameters that the components declare: editors
// complete and check with it. `meristem schema` prints it.
//
// Definitions that a schema fragment of a Raw parameter may refer to ("#/definitions/..."): every kind of the catalogue
// (any component of it), every section, "expression" (a number or a text) and "vector_expression" (a number, a text, or
// three expressions). What the schema refuses, the loader refuses; the loader knows more (expressions, names of
// models).
#pragma once

#include "renderer/language/catalogue.h"

#include <string>

namespace meristem {

std::string json_schema(const Catalogue& catalogue);

}  // namespace meristem
