#include "geometry/volumes/vdb_codec.h"

#include "geometry/base/module.h"

namespace meristem {

namespace {

const VdbCodec* open_codec() {
  return reinterpret_cast<decltype(&meristem_vdb_codec)>(open_module("meristem_vdb.so", "meristem_vdb_codec"))();
}

}  // namespace

const VdbCodec& vdb_codec() {
  static const VdbCodec* const codec = open_codec();
  return *codec;
}

}  // namespace meristem
