#pragma once

#include <string_view>

namespace grainlaw::report {

/// Look of the page: light and dark as the reader's system asks, paper when printed.
inline constexpr std::string_view style_sheet = R"(
:root {
  color-scheme: light dark;
  --ink: #1c1e21; --soft: #5a6068; --paper: #ffffff; --line: #c6cad0; --tint: #f3f4f6;
  --link: #1f5fa8;
}
@media (prefers-color-scheme: dark) {
  :root {
    --ink: #e3e5e8; --soft: #a2a9b2; --paper: #15171a; --line: #40464e; --tint: #1f2226;
    --link: #86b6ee;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 2.5rem 1.5rem 4rem; max-width: 72rem;
  background: var(--paper); color: var(--ink);
  font: 1rem/1.55 Charter, "Bitstream Charter", "Source Serif 4", "Palatino Linotype", Palatino,
    "DejaVu Serif", Georgia, serif;
}
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 0.4rem; }
h2 { font-size: 1.35rem; margin: 2.8rem 0 0.8rem; padding-top: 0.9rem;
  border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.8rem 0 0.4rem; }
h1, h2, h3 { font-weight: 600; }
p, ul, dl, h1 { max-width: 47rem; }
p, ul { margin: 0.7rem 0; }
ul { padding-left: 1.2rem; }
li { overflow-wrap: anywhere; }
a { color: var(--link); text-decoration-thickness: 1px; text-underline-offset: 0.15em; }
code { font-size: 0.88em; overflow-wrap: anywhere; }
.made, nav { color: var(--soft); font-size: 0.92rem; }
nav a { margin-right: 0.9rem; white-space: nowrap; }
dl { margin: 0.7rem 0; }
dt { font-weight: 600; }
dd { margin: 0 0 0.7rem; overflow-wrap: anywhere; }
dl.summary { display: grid; grid-template-columns: 9.5rem 1fr; gap: 0.45rem 1rem;
  max-width: 60rem; }
dl.summary dd { margin: 0; }
@media (max-width: 40rem) { dl.summary { display: block; } dl.summary dd { margin-bottom: 0.6rem; } }
.note { border-left: 3px solid #d0541b; padding: 0.1rem 0 0.1rem 0.9rem; margin: 1.2rem 0;
  max-width: 60rem; }
.aside { color: var(--soft); font-size: 0.88rem; }
.aside ul { margin: 0.2rem 0 1rem; }
summary { cursor: pointer; color: var(--link); margin: 0.7rem 0; }
.scroll { overflow-x: auto; margin: 1rem 0 1.4rem; }
table { border-collapse: collapse; border-top: 1.5px solid var(--ink);
  border-bottom: 1.5px solid var(--ink); font: 0.84rem/1.35 system-ui, "Segoe UI", Roboto,
  "DejaVu Sans", sans-serif; font-variant-numeric: tabular-nums lining-nums; }
caption { text-align: left; color: var(--soft); padding-bottom: 0.45rem; }
th, td { padding: 0.28rem 0 0.28rem 1.05rem; text-align: right; }
th code, td code { font-size: 0.95em; overflow-wrap: break-word; }
th { font-weight: 600; vertical-align: bottom; }
thead th { border-bottom: 1px solid var(--ink); }
thead th:not(.words) { max-width: 6.2rem; }
th.words, td.words { text-align: left; }
td { vertical-align: top; }
.prose { display: inline-block; width: min(26rem, 32vw); text-align: left; }
.prose.short { width: min(16rem, 30vw); }
@media (max-width: 52rem) { table { font-size: 0.76rem; } th, td { padding-left: 0.6rem; } }
tr > :first-child { padding-left: 0.2rem; }
tr > :last-child { padding-right: 0.2rem; }
tr.group th { padding-top: 0.8rem; font-style: italic; font-weight: 400; }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(18rem, 100%), 1fr));
  gap: 0.6rem 1.6rem; margin: 0.6rem 0 1.2rem; }
.figures.two { grid-template-columns: repeat(auto-fill, minmax(min(28rem, 100%), 1fr)); }
.figures.four { grid-template-columns: repeat(2, minmax(0, 26rem)); }
@media (max-width: 40rem) { .figures.four { grid-template-columns: 1fr; } }
figure { margin: 0; max-width: 34rem; font-family: system-ui, "Segoe UI", Roboto, "DejaVu Sans",
  sans-serif; }
figure svg { display: block; width: 100%; height: auto; }
figcaption { color: var(--soft); font-size: 0.82rem; line-height: 1.4; margin-top: 0.15rem; }
figcaption a { color: inherit; }
.missing { border: 1px dashed var(--line); padding: 1.5rem 1rem; color: var(--soft);
  font-size: 0.88rem; }
@page { margin: 16mm; }
@media print {
  :root { --ink: #000; --soft: #444; --paper: #fff; --line: #bbb; --tint: #fff; --link: #000;
    color-scheme: light; }
  body { max-width: none; padding: 0; font-size: 10pt; }
  nav { display: none; }
  .scroll { overflow: visible; }
  table { font-size: 7.5pt; }
  th, td { padding-left: 0.7em; }
  .figures { grid-template-columns: repeat(3, 1fr); }
  .figures.two, .figures.four { grid-template-columns: repeat(2, 1fr); }
  figure, tr, dd, li, .scroll { break-inside: avoid; }
  h2, h3, caption { break-after: avoid; }
}
)";

}  // namespace grainlaw::report
