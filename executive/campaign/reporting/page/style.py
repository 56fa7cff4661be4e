"""The style sheet of pages: plain, narrow enough for a phone, black on white in print."""

STYLE = """
:root { --ink: #1c2127; --soft: #5c6670; --line: #d9dee3; --paper: #ffffff; --panel: #f5f7f9;
  --good: #1a7f4e; --bad: #b3261e; --unsure: #8a5a00; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 1.5rem 1rem 4rem; }
h1 { font-size: 1.8rem; line-height: 1.2; margin: .5rem 0 .25rem; overflow-wrap: anywhere; }
h2 { font-size: 1.3rem; margin: 2.5rem 0 .75rem; padding-top: .75rem;
  border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.5rem 0 .25rem; }
nav { display: flex; flex-wrap: wrap; gap: .2rem 1rem; font-size: .85rem; }
a { color: #0b63a5; text-decoration: none; }
p { margin: .4rem 0; max-width: 46rem; }
.lead { font-size: 1.1rem; color: var(--soft); }
.note { color: var(--soft); font-size: .9rem; }
code, pre { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "Liberation Mono", monospace;
  font-size: .82rem; }
pre { background: var(--panel); border-radius: 4px; padding: .6rem .75rem; margin: .4rem 0;
  white-space: pre-wrap; overflow-wrap: anywhere; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: .75rem 0; }
dt { color: var(--soft); }
dd { margin: 0; overflow-wrap: anywhere; min-width: 0; }
ul { margin: .4rem 0; padding-left: 1.2rem; }
.table { overflow-x: auto; margin: .6rem 0; }
table { border-collapse: collapse; font-size: .88rem; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .25rem .9rem .25rem 0;
  border-bottom: 1px solid var(--line); }
td { min-width: 4.5rem; }
th { color: var(--soft); font-weight: 600; white-space: nowrap; }
.number { text-align: right; white-space: nowrap; min-width: 0; }
.good { color: var(--good); font-weight: 600; }
.bad { color: var(--bad); font-weight: 600; }
.unsure { color: var(--unsure); font-weight: 600; }
.verdict { white-space: nowrap; }
.run { border-left: 3px solid var(--bad); padding-left: .8rem; margin: 1rem 0; }
.run h3 { margin-top: 0; }
.chart { width: 100%; margin: .5rem 0 1rem; }
.chart svg { max-width: 100%; height: auto; }
summary { cursor: pointer; }
@media (max-width: 36rem) {
  dl { grid-template-columns: 1fr; gap: 0; }
  dd { margin-bottom: .5rem; }
}
@media print {
  body { font-size: 10pt; }
  main { max-width: none; padding: 0; }
  h2, h3 { break-after: avoid; }
  .run, .chart, tr { break-inside: avoid; }
  .table { overflow: visible; }
  nav { display: none; }
}
"""
