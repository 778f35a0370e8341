#include "renderer/film/film_parts.h"

#include "renderer/film/cryptomatte.h"

namespace meristem {

namespace {

const std::vector<std::string>& names_of(Aov matte, const SceneNames& names) {
  if (matte == Aov::CryptoObject) return names.objects;
  return matte == Aov::CryptoMaterial ? names.materials : names.productions;
}

ExrPart matte_part(const Film& film, Aov aov, const std::vector<std::string>& names) {
  const std::string type = info_of(aov).name;
  return {type,
          cryptomatte::channel_names(type, cryptomatte::layers),
          film.develop_matte(aov, cryptomatte::name_hashes(names), cryptomatte::layers),
          false,
          false,
          cryptomatte::metadata(type, names)};
}

ExrPart data_part(const Film& film, Aov aov) {
  const AovInfo& info = info_of(aov);
  return {info.name, {info.channels.begin(), info.channels.end()}, film.develop(aov),
          false,     aov == Aov::Albedo || aov == Aov::SecondHalf, {{"meristem:meaning", info.doc}}};
}

}  // namespace

std::vector<ExrPart> film_parts(const Film& film, const SceneNames& names, bool half) {
  std::vector<ExrPart> parts{{"beauty", {"R", "G", "B", "A"}, film.develop(), half, true}};
  for (const Aov aov : film.aovs())
    parts.push_back(info_of(aov).channels.empty() ? matte_part(film, aov, names_of(aov, names)) : data_part(film, aov));
  return parts;
}

}  // namespace meristem
