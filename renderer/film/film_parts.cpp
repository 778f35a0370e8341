#include "renderer/film/film_parts.h"

#include "renderer/film/cryptomatte.h"

namespace meristem {

namespace {

const std::vector<std::string>& names_of(Aov matte, const SceneNames& names) {
  if (matte == Aov::CryptoObject) return names.objects;
  return matte == Aov::CryptoMaterial ? names.materials : names.productions;
}

ExrRows rows_of(const Film& film, ExrRows::Fill fill) {
  return {film.window().width(), film.window().height(), std::move(fill)};
}

ExrPart beauty_part(const Film& film, bool half) {
  const auto fill = [&film](int begin, int end, float* values) { film.develop(begin, end, values); };
  return {"beauty", {"R", "G", "B", "A"}, rows_of(film, fill), half, true};
}

ExrPart matte_part(const Film& film, Aov aov, const std::vector<std::string>& names) {
  const std::string type = info_of(aov).name;
  const auto fill = [&film, aov, hashes = cryptomatte::name_hashes(names)](int begin, int end, float* values) {
    film.develop_matte(aov, hashes, cryptomatte::layers, begin, end, values);
  };
  return {type,
          cryptomatte::channel_names(type, cryptomatte::layers),
          rows_of(film, fill),
          false,
          false,
          cryptomatte::metadata(type, names)};
}

ExrPart data_part(const Film& film, Aov aov) {
  const AovInfo& info = info_of(aov);
  const auto fill = [&film, aov](int begin, int end, float* values) { film.develop(aov, begin, end, values); };
  return {info.name, {info.channels.begin(), info.channels.end()}, rows_of(film, fill),
          false,     aov == Aov::Albedo || aov == Aov::SecondHalf, {{"meristem:meaning", info.doc}}};
}

}  // namespace

std::vector<ExrPart> film_parts(const Film& film, const SceneNames& names, bool half) {
  std::vector<ExrPart> parts{beauty_part(film, half)};
  for (const Aov aov : film.aovs())
    parts.push_back(info_of(aov).channels.empty() ? matte_part(film, aov, names_of(aov, names)) : data_part(film, aov));
  return parts;
}

}  // namespace meristem
