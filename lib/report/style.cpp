// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/page.h"

namespace ada {

// Before is orange and after blue, apart for colour-blind eyes and in grey print.
const char *const kStyle = R"css(
:root{--paper:#fff;--card:#f6f7f9;--ink:#16191d;--muted:#5b6470;--grid:#e3e6ea;--line:#d4d8de;
--before:#c2560c;--after:#0b62b8;--measured:#3c434c;--floor:#1b7f3b;
--good:#1b7f3b;--warn:#a15c00;--bad:#b3261e;color-scheme:light}
@media screen and (prefers-color-scheme:dark){:root{--paper:#14171b;--card:#1c2026;--ink:#e8eaed;
--muted:#9aa4b1;--grid:#2b3138;--line:#363d46;--before:#f0924a;--after:#63b1f7;--measured:#c3cad3;
--floor:#5cc781;--good:#5cc781;--warn:#f0b04a;--bad:#ff8a80;color-scheme:dark}}
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:var(--paper);color:var(--ink);
font:15px/1.5 "Noto Sans","Liberation Sans","Segoe UI",system-ui,Arial,sans-serif;
font-variant-numeric:tabular-nums}
main{max-width:1120px;margin:0 auto;padding:28px 24px 48px}
h1{font-size:27px;line-height:1.25;margin:2px 0 8px;font-weight:650;text-wrap:balance}
h2{font-size:18px;margin:38px 0 6px;padding-top:10px;border-top:1px solid var(--line);font-weight:650}
h3{font-size:16px;margin:0;font-weight:650}
h4{font-size:14px;margin:0 0 4px;font-weight:650}
p{margin:6px 0;max-width:78ch}
.over{color:var(--muted);font-size:13px;margin:0}
.note{color:var(--muted);font-size:13.5px}
.explained,.no-discrepancy{--tone:var(--good)}
.partly-explained,.unexplained{--tone:var(--warn)}
.insufficient-data{--tone:var(--bad)}
header{border-left:5px solid var(--tone);padding-left:16px}
.tiles{display:flex;flex-wrap:wrap;gap:12px;margin:18px 0 4px}
.tile{flex:1 1 190px;background:var(--card);border-radius:6px;padding:10px 14px}
.tile b{display:block;font-size:20px;font-weight:600;white-space:nowrap}
.tile span{color:var(--muted);font-size:13px}
table{border-collapse:collapse;margin:8px 0;font-size:14px}
th{font-weight:600;text-align:left;color:var(--muted);font-size:13px}
th,td{padding:4px 18px 4px 0;border-bottom:1px solid var(--line);vertical-align:top}
td.n,th.n{text-align:right;white-space:nowrap}
th[scope=row]{color:var(--ink);font-size:14px}
code{font:12.5px/1.4 "Noto Sans Mono","Liberation Mono",Consolas,monospace;color:var(--muted)}
figure{margin:0;min-width:0}
figcaption{color:var(--muted);font-size:13px;line-height:1.4}
svg{display:block;width:100%;height:auto;overflow:visible;
font-family:"Noto Sans","Liberation Sans","Segoe UI",system-ui,Arial,sans-serif}
svg.marks{position:absolute;width:0;height:0}
.row{display:grid;gap:14px 20px;margin-top:12px}
.panels{grid-template-columns:repeat(auto-fill,minmax(240px,1fr))}
.half{grid-template-columns:repeat(auto-fit,minmax(400px,1fr))}
.wide{grid-template-columns:2.08fr 1fr;align-items:end}
.half figure{max-width:540px}
.panels figure{max-width:275px}
.legend{display:flex;flex-wrap:wrap;gap:2px 18px;font-size:13px;color:var(--muted);margin:8px 0 0;
padding:0;list-style:none}
.legend i{display:inline-block;width:18px;height:0;border-top:3px solid;margin-right:6px;
vertical-align:middle}
.legend i.dot{width:9px;height:9px;border:0;border-radius:5px;background:currentColor}
.legend i.ring{width:9px;height:9px;border:1.5px solid;border-radius:5px}
.legend i.dash{border-top:2px dashed}
.before{color:var(--before)}.after{color:var(--after)}.measured{color:var(--measured)}
.muted{color:var(--muted)}.floor{color:var(--floor)}
.finding{border:1px solid var(--line);border-radius:8px;padding:14px 18px 16px;margin:14px 0}
.finding>p{margin:4px 0}
.finding h3 span{color:var(--muted);font-weight:400}
.facts{display:flex;flex-wrap:wrap;gap:4px 44px}
.facts>div{min-width:0}
.tag{display:inline-block;border:1px solid var(--line);border-radius:10px;padding:0 9px;
font-size:12.5px;color:var(--muted);margin-left:8px;font-weight:400}
.rivals{background:var(--card);border-radius:6px;padding:8px 12px;margin:8px 0 0;font-size:14px;
max-width:none}
ul.plain{margin:6px 0;padding-left:20px}
a{color:var(--after)}
footer{margin-top:36px;border-top:1px solid var(--line);padding-top:8px;color:var(--muted);
font-size:13px}
@media (max-width:760px){.wide{grid-template-columns:1fr}.half{grid-template-columns:1fr}
main{padding:18px 14px 32px}h1{font-size:22px}}
@page{size:A4;margin:14mm 13mm}
@media print{body{font-size:9.5pt;line-height:1.4;background:#fff}main{max-width:none;padding:0}
h1{font-size:16pt}h2{font-size:12pt;margin-top:16pt;break-after:avoid}
.panels{grid-template-columns:repeat(4,1fr);gap:6pt 8pt}
.half{grid-template-columns:repeat(2,1fr)}.half figure,.panels figure{max-width:none}
.wide{grid-template-columns:2.08fr 1fr}
figure,.finding .facts,tr,.tile{break-inside:avoid}
.finding{break-inside:avoid;padding:8pt 10pt}
.tile,.rivals{background:none;border:1px solid var(--line)}
.note,figcaption,.legend,.over,.tile span{font-size:8.5pt}table,.rivals,th[scope=row]{font-size:9pt}thead th{font-size:8.5pt}
.tiles{flex-wrap:nowrap;gap:6pt}.tile{flex:1 1 auto;padding:6pt 8pt}.tile b{font-size:12pt}
svg text{font-size:15px}.half svg text,.wide svg text{font-size:16px}
*{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)css";

} // namespace ada
