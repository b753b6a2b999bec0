// SPDX-License-Identifier: BSD-3-Clause
#include "clearance_svg.hpp"

#include "report_text.hpp"

#include <clearance/io/sentence.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

using namespace clearance;

namespace {

constexpr double width = 960, height = 400, left = 80, right = width - 20, top = 50, bottom = height - 50;

/// Text for an XML file: one printable line of UTF-8, with XML's own characters escaped, and without the two that XML
/// does not allow.
std::string escaped(const std::string& words) {
  std::string line = io::sentence(words, 80), out;
  for (const char* never : {"\xEF\xBF\xBE", "\xEF\xBF\xBF"})
    for (std::size_t at; (at = line.find(never)) != line.npos;) line.replace(at, 3, "\xEF\xBF\xBD");
  for (const char c : line) {
    constexpr const char* names[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
    const std::size_t which = std::string_view("&<>\"'").find(c);
    which == std::string_view::npos ? out += c : out += names[which];
  }
  return out;
}

struct axes {
  double low, high, highest;  // metres; a few frames may be above `high`, up to `highest`
  std::size_t frames;

  double x(double frame) const {
    return frames < 2 ? (left + right) / 2 : left + (right - left) * frame / double(frames - 1);
  }
  double y(double metres) const {
    return std::clamp(bottom - (bottom - top) * ((metres - low) / (high - low)), top, bottom);
  }
  std::string at(std::size_t frame, double metres) const { return text("%.2f %.2f", x(double(frame)), y(metres)); }
};

/// The height of a frame: the upper end of its bracket if that is finite, else its distance, else its lower end.
double top_of(const min_distance_result& r) {
  for (const real end : {r.upper, r.distance, r.lower})
    if (std::isfinite(end)) return end;
  return 0;
}

/// The axis shows 0, the margin and what is below. It leaves out outliers, which would flatten the rest: frames above
/// three times the value that nine of ten stay below.
axes around(const svg_frames& drawn, std::optional<double> margin) {
  axes made{0, 0, 0, drawn.seen.size()};
  const auto hold = [&](double metres) {
    if (std::isfinite(metres)) {
      made.low = std::min(made.low, metres);
      made.high = std::max(made.high, metres);
    }
  };
  std::vector<double> tops;
  for (const auto* some : {&drawn.seen, &drawn.certain, &drawn.unseen})
    for (const min_distance_result& r : *some) {
      if (r.state == state::no_data) continue;
      hold(std::min(0.0, double(r.distance)));
      hold(std::min(0.0, double(r.lower)));
      if (const double above = top_of(r); above > 0) tops.push_back(above);
    }
  std::sort(tops.begin(), tops.end());
  const double most = tops.empty() ? 0 : 3 * tops[(tops.size() - 1) * 9 / 10];
  for (const double above : tops)
    if (above <= most) hold(above);
  if (margin) hold(*margin);
  made.highest = tops.empty() ? made.high : std::max(made.high, tops.back());
  if (!(made.high - made.low > 0)) made.high = made.low + 1;
  return made;
}

/// Triangles along the upper edge.
std::string marks(const axes& to, std::span<const min_distance_result> frames) {
  std::string out;
  for (std::size_t k = 0; k < frames.size(); ++k)
    if (frames[k].state != state::no_data && top_of(frames[k]) > to.high)
      out += text("M %.2f %.2f l -4 7 h 8 Z\n", to.x(double(k)), top);
  return out;
}

/// A round number, about a fifth of the range.
double step_of(double range) {
  const double power = std::pow(10, std::floor(std::log10(range / 5)));
  for (const double step : {power, 2 * power, 5 * power})
    if (range / step <= 6) return step;
  return 10 * power;
}

std::string words(double x, double y, const char* anchor, const std::string& says) {
  return text("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"%s\">", x, y, anchor) + says + "</text>\n";
}

std::string grid(const axes& to) {
  std::string out;
  const double step = step_of(to.high - to.low),
               frame_step = std::max(1.0, step_of(double(std::max<std::size_t>(to.frames, 2) - 1)));
  for (double tick = std::ceil(to.low / step); tick * step <= to.high; ++tick)
    out += text("<path stroke=\"#ddd\" d=\"M %.2f %.2f H %.2f\"/>\n", left, to.y(tick * step), right) +
           words(left - 6, to.y(tick * step) + 4, "end", text("%g", tick * step + 0));  // no -0
  for (double tick = 0; tick < double(to.frames); tick += frame_step)
    out += words(to.x(tick), bottom + 18, "middle", text("%g", tick));
  return out + words((left + right) / 2, height - 12, "middle", "frame") + words(left - 6, top - 12, "end", "m");
}

/// A line of distances in the band of its brackets. Frames that are alone among unknown ones are dots.
struct curve {
  std::string band, line, alone;

  curve(const axes& to, std::span<const min_distance_result> frames) {
    for (std::size_t begin = 0, end; begin < frames.size(); begin = end) {
      const bool known = frames[begin].state != state::no_data;
      for (end = begin; end < frames.size() && (frames[end].state != state::no_data) == known;) ++end;
      if (!known) continue;
      for (std::size_t k = begin; k < end; ++k) {
        band += (k == begin ? "M " : "L ") + to.at(k, frames[k].upper) + '\n';
        line += (k == begin ? "M " : "L ") + to.at(k, frames[k].distance) + '\n';
      }
      for (std::size_t k = end; k-- > begin;) band += "L " + to.at(k, frames[k].lower) + '\n';
      band += "Z\n";
      if (end - begin == 1) alone += "M " + to.at(begin, frames[begin].distance) + " h 0\n";  // a round end is a dot
    }
  }
  /// `of` begins the names of the paths.
  std::string shaded(const char* of, const char* light) const {
    if (line.empty()) return {};
    return text("<path id=\"%sbracket\" fill=\"%s\" fill-opacity=\"0.35\" stroke=\"%s\" stroke-opacity=\"0.6\" ", of,
                light, light) +
           "stroke-width=\"0.5\" d=\"" + band + "\"/>\n";
  }
  /// The colours are the band's and the line's.
  std::string drawn(const char* of, const char* light, const char* dark) const {
    std::string out = shaded(of, light);
    if (!line.empty())
      out += text("<path id=\"%sdistance\" stroke=\"%s\" ", of, dark) +
             "stroke-width=\"1.5\" stroke-linecap=\"round\" stroke-linejoin=\"round\" d=\"" + line + "\"/>\n";
    if (!alone.empty())
      out += text("<path id=\"%salone\" stroke=\"%s\" stroke-width=\"5\" stroke-linecap=\"round\" d=\"", of, dark) +
             alone + "\"/>\n";
    return out;
  }
};

/// Bars where nothing is known.
std::string bars(const axes& to, std::span<const min_distance_result> frames) {
  std::string out;
  for (std::size_t begin = 0, end; begin < frames.size(); begin = end) {
    const bool known = frames[begin].state != state::no_data;
    for (end = begin; end < frames.size() && (frames[end].state != state::no_data) == known;) ++end;
    if (known) continue;
    const double from = std::max(left, to.x(double(begin) - 0.5)), until = std::min(right, to.x(double(end) - 0.5));
    out += text("<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>\n", from, top,
                std::max(until - from, 2.0), bottom - top);
  }
  return out;
}

}  // namespace

std::string clearance_svg(const svg_frames& drawn, const std::string& name, std::optional<double> margin) {
  const auto& [frames, certain, unseen] = drawn;
  const axes to = around(drawn, margin);
  const std::string above = marks(to, frames) + marks(to, unseen), blind = bars(to, frames);
  const std::string legend =
      std::string("distance, in its bracket") + (certain.empty() ? "" : "; grey: with what is uncertain") +
      (unseen.empty() ? "" : "; orange: to what is not seen") + (blind.empty() ? "" : "; red: no data");

  std::string out =
      text(
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\" "
          "font-family=\"sans-serif\" font-size=\"12\" fill=\"none\">\n<title>Clearance in ",
          width, height) +
      escaped(name) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  out +=
      "<g fill=\"#333\">\n" + words(left, 20, "start", "Clearance in " + escaped(name)) + grid(to) +
      words(right, 20, "end", legend) +
      (above.empty() ? ""
                     : words(right, top - 12, "end", text("triangles: above the picture, up to %.3g m", to.highest))) +
      "</g>\n";

  if (!blind.empty()) out += "<g fill=\"#d33\" fill-opacity=\"0.35\">\n" + blind + "</g>\n";
  out += curve(to, certain).shaded("certain-", "#777") + curve(to, unseen).drawn("unseen-", "#e80", "#a50") +
         curve(to, frames).drawn("", "#48c", "#136");
  if (!above.empty()) out += "<path id=\"above\" fill=\"#136\" d=\"" + above + "\"/>\n";
  if (margin)
    out += text("<path id=\"margin\" stroke=\"#d33\" stroke-dasharray=\"6 4\" d=\"M %.2f %.2f H %.2f\"/>\n", left,
                to.y(*margin), right) +
           "<g fill=\"#d33\">\n" + words(right, to.y(*margin) - 4, "end", text("margin %g m", *margin)) + "</g>\n";
  return out + "</svg>\n";
}
