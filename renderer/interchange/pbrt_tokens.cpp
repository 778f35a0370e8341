#include "renderer/interchange/pbrt_tokens.h"

#include "geometry/io/whole_file.h"
#include "renderer/interchange/foreign_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace meristem {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_depth = 16;  // of includes

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0'; }

}  // namespace

PbrtTokens::PbrtTokens(const std::string& path, Diagnostics& diagnostics)
    : diagnostics_(diagnostics), folder_(fs::absolute(path).parent_path().string()) {
  open(fs::weakly_canonical(path).string(), path, {});
}

void PbrtTokens::include(const std::string& file, const Location& where) {
  const std::string path = path_inside(folder_, file);
  if (path.empty()) return diagnostics_.error(where, fmt::format("\"{}\" leaves the folder of the scene", file));
  if (open_.size() >= most_depth)
    return diagnostics_.error(where, fmt::format("more than {} files include each other", most_depth));
  if (std::ranges::find(open_, path, &Open::path) != open_.end())
    return diagnostics_.error(where, fmt::format("\"{}\" includes itself", file));
  open(path, file, where);
}

void PbrtTokens::open(const std::string& path, const std::string& name, const Location& where) {
  std::string reason;
  std::optional<std::string> text = read_whole_file(path, reason, most_file_bytes - bytes_);
  if (!text) return diagnostics_.error(where, std::move(reason));
  bytes_ += text->size();
  auto source = std::make_shared<SourceText>(SourceText{name, std::move(*text)});
  open_.push_back({std::move(source), path, 0});
}

const PbrtToken& PbrtTokens::peek() {
  if (!has_peeked_) peeked_ = read();
  has_peeked_ = true;
  return peeked_;
}

PbrtToken PbrtTokens::next() {
  if (!has_peeked_) return read();
  has_peeked_ = false;
  return peeked_;
}

void PbrtTokens::skip_blanks(Open& file) const {
  const std::string& text = file.source->text;
  while (file.at < text.size() && (is_blank(text[file.at]) || text[file.at] == '#'))
    if (text[file.at] == '#')
      file.at = std::min(text.find('\n', file.at), text.size());
    else
      ++file.at;
}

PbrtToken PbrtTokens::read() {
  while (!open_.empty()) {
    Open& file = open_.back();
    skip_blanks(file);
    const std::string& text = file.source->text;
    if (file.at >= text.size()) {
      open_.pop_back();
      continue;
    }
    const std::size_t start = file.at;
    const Location where{file.source, start};
    const auto token = [&](PbrtToken::Kind kind, std::size_t first, std::size_t last, std::size_t next) {
      file.at = next;
      return PbrtToken{kind, std::string_view(text).substr(first, last - first), where};
    };
    if (text[start] == '[') return token(PbrtToken::Kind::Open, start, start + 1, start + 1);
    if (text[start] == ']') return token(PbrtToken::Kind::Close, start, start + 1, start + 1);
    if (text[start] == '"') {
      const std::size_t end = text.find_first_of("\"\n", start + 1);
      if (end != std::string::npos && text[end] == '"') return token(PbrtToken::Kind::Text, start + 1, end, end + 1);
      diagnostics_.error(where, "the text has no closing quote");
      return token(PbrtToken::Kind::Text, start + 1, std::min(end, text.size()), std::min(end, text.size()));
    }
    const std::size_t end = std::min(text.find_first_of(std::string_view(" \t\r\n\"[]#\0", 9), start), text.size());
    return token(PbrtToken::Kind::Word, start, end, end);
  }
  return {};
}

}  // namespace meristem
