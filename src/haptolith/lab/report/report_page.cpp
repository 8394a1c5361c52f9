#include "haptolith/lab/report/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"

namespace haptolith {

namespace {

// Figures keep a white background in dark mode because gnuplot draws in black.
constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --ground: #ffffff; --ink: #1c1c1c; --faint: #5c5c5c; --rule: #d4d4d4;
        --head: #f3f3f3; --pass: #17692f; --fail: #b3201b; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #161616; --ink: #e8e8e8; --faint: #a6a6a6; --rule: #3d3d3d; --head: #232323; --pass: #6fcf86;
          --fail: #ff8a80; }
}
body { max-width: 72rem; margin: 2rem auto; padding: 0 1rem; background: var(--ground); color: var(--ink);
       font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.25; }
h2 { font-size: 1.25rem; margin-top: 2.5rem; }
p { max-width: 45rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.2rem 1.5rem; }
dt { color: var(--faint); }
dd { margin: 0; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; }
th, td { padding: 0.45rem 0.7rem; border-bottom: 1px solid var(--rule); text-align: left; vertical-align: top; }
thead th { background: var(--head); }
tbody th { font-weight: 600; }
.verdict { display: block; font-size: 0.85rem; color: var(--faint); }
.pass { color: var(--pass); font-weight: 600; }
.fail { color: var(--fail); font-weight: 600; }
figure { margin: 1.5rem 0; }
img { max-width: min(100%, 56rem); height: auto; background: #ffffff; border: 1px solid var(--rule); }
figcaption { max-width: 45rem; color: var(--faint); }
)";

std::string_view word(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass: return "pass";
    case Verdict::kFail: return "fail";
    case Verdict::kInfo: return "info";
  }
  return "";
}

std::string readFile(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || bytes.empty()) {
    throw Failure(
        fmt::format("cannot read the figure {}: {}", path.string(), errno != 0 ? std::strerror(errno) : "it is empty"));
  }
  return bytes;
}

std::string_view mediaType(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char letter) { return std::tolower(letter); });
  if (extension == ".svg") {
    return "image/svg+xml";
  }
  if (extension == ".png") {
    return "image/png";
  }
  throw InvalidParameter("figure", fmt::format("'{}'", path.string()), "a file that ends in .svg or .png");
}

std::string factsHtml(const std::vector<ReportFact>& facts) {
  if (facts.empty()) {
    return "";
  }
  std::string html = "<dl>\n";
  for (const ReportFact& fact : facts) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", htmlEscaped(fact.name), htmlEscaped(fact.value));
  }
  return html + "</dl>\n";
}

std::string valueHtml(const ReportValue& value) {
  if (!value.verdict) {
    return fmt::format("<td>{}</td>", htmlEscaped(value.text));
  }
  const std::string_view verdict = word(*value.verdict);
  return fmt::format("<td>{} <span class=\"verdict {}\">{}</span></td>", htmlEscaped(value.text), verdict, verdict);
}

std::string tableHtml(const std::vector<ReportRow>& rows) {
  if (rows.empty()) {
    return "";
  }
  std::string html =
      "<h2>Results</h2>\n<div class=\"wide\">\n<table>\n<thead>\n<tr><th scope=\"col\">Test</th>"
      "<th scope=\"col\">Measured</th><th scope=\"col\">Target</th><th scope=\"col\">Contact friction</th>"
      "<th scope=\"col\">ICRA 2021 friction</th></tr>\n</thead>\n<tbody>\n";
  for (const ReportRow& row : rows) {
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td>{}{}</tr>\n", htmlEscaped(row.test),
                        htmlEscaped(row.measured), htmlEscaped(row.target), valueHtml(row.contact),
                        valueHtml(row.icra2021));
  }
  return html + "</tbody>\n</table>\n</div>\n";
}

// All figures, also SVG, are embedded as data URLs: gnuplot uses the same ids in different figures, which would clash.
std::string figuresHtml(const std::vector<ReportFigure>& figures) {
  if (figures.empty()) {
    return "";
  }
  std::string html = "<h2>Figures</h2>\n";
  for (const ReportFigure& figure : figures) {
    const std::string_view type = mediaType(figure.file);
    const std::string caption = htmlEscaped(figure.caption);
    html += fmt::format(
        "<figure>\n<img alt=\"{}\" src=\"data:{};base64,{}\">\n<figcaption>{}</figcaption>\n"
        "</figure>\n",
        caption, type, base64(readFile(figure.file)), caption);
  }
  return html;
}

}  // namespace

std::string htmlEscaped(std::string_view text) {
  std::string escaped;
  for (const char letter : text) {
    switch (letter) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\'': escaped += "&#39;"; break;
      default: escaped += letter;
    }
  }
  return escaped;
}

std::string reportHtml(const ReportPage& page) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
      "<style>{}</style>\n</head>\n<body>\n<h1>{}</h1>\n",
      htmlEscaped(page.title), kStyle, htmlEscaped(page.title));
  for (const std::string& paragraph : page.introduction) {
    html += fmt::format("<p>{}</p>\n", htmlEscaped(paragraph));
  }
  html += factsHtml(page.facts);
  html += tableHtml(page.rows);
  html += figuresHtml(page.figures);
  return html + "</body>\n</html>\n";
}

void saveReport(const OutputFile& path, const ReportPage& page) {
  const std::string html = reportHtml(page);
  AtomicFile file(path);
  file.write(html);
  file.commit();
}

}  // namespace haptolith
