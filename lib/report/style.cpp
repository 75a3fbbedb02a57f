// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/page.h"

namespace ada {

// Before is orange and after blue, apart for colour-blind eyes and in grey print; what has no name
// is hatched besides.
const char *const kStyle = R"css(
:root{--paper:#fff;--card:#f6f7f9;--ink:#16191d;--muted:#5b6470;--grid:#e3e6ea;--line:#d4d8de;
--before:#c2560c;--after:#0b62b8;--measured:#3c434c;--floor:#1b7f3b;--pale:#c3c9d1;--second:#8a3aa8;
--good:#1b7f3b;--warn:#a15c00;--bad:#b3261e;color-scheme:light}
@media screen and (prefers-color-scheme:dark){:root{--paper:#14171b;--card:#1c2026;--ink:#e8eaed;
--muted:#9aa4b1;--grid:#2b3138;--line:#363d46;--before:#f0924a;--after:#63b1f7;--measured:#c3cad3;
--floor:#5cc781;--pale:#4b545f;--second:#d097ea;--good:#5cc781;--warn:#f0b04a;--bad:#ff8a80;
color-scheme:dark}}
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:var(--paper);color:var(--ink);
font:15px/1.5 "Noto Sans","Liberation Sans","Segoe UI",system-ui,Arial,sans-serif;
font-variant-numeric:tabular-nums}
main{max-width:1120px;margin:0 auto;padding:28px 24px 48px}
h1{font-size:27px;line-height:1.25;margin:2px 0 8px;font-weight:650;text-wrap:balance}
h2{font-size:18px;margin:38px 0 6px;padding-top:10px;border-top:1px solid var(--line);font-weight:650}
h3{font-size:16px;margin:0;font-weight:650}
p{margin:6px 0;max-width:78ch}
.over{color:var(--muted);font-size:13px;margin:0;overflow-wrap:anywhere}
.note{color:var(--muted);font-size:13.5px}
.notice,.undrawn{border:1px solid var(--warn);border-radius:6px;padding:8px 12px;max-width:none}
.undrawn{font-size:13px;overflow-wrap:anywhere}
.explained,.no-discrepancy{--tone:var(--good)}
.partly-explained,.unexplained{--tone:var(--warn)}
.insufficient-data{--tone:var(--bad)}
header{border-left:5px solid var(--tone);padding-left:16px}
header+h2,.notice+h2{margin-top:20px}
.budget{margin:10px 0 6px}
.line{display:grid;grid-template-columns:250px 1fr;gap:2px 20px;padding:9px 0;
border-bottom:1px solid var(--line)}
.what b{display:block}.what span{color:var(--muted);font-size:13px}
.bar{position:relative;display:flex;align-items:center;gap:3px;min-height:24px}
.bar::after{content:"";position:absolute;top:0;bottom:0;left:calc(var(--noise)*.74%);
border-left:2px dashed var(--floor)}
.bar>span{position:relative;z-index:1;background:var(--paper);padding:0 6px;font-size:14px;
white-space:nowrap}
.fill{display:flex;flex:none;gap:1px;height:18px;min-width:2px;width:calc(var(--w)*.74%);
overflow:hidden;border-radius:2px}
.fill i{flex:1 1 0;min-width:0;overflow:hidden;background:var(--after);color:var(--paper);
font-weight:600;font-size:11.5px;line-height:18px;font-style:normal;text-align:center}
.fill i:nth-child(even){opacity:.72}
.named{background:var(--after)}
.unnamed{background:repeating-linear-gradient(135deg,var(--before) 0 5px,var(--paper) 5px 7px);
outline:1px solid var(--before);outline-offset:-1px}
.noise{background:var(--muted)}
.plain .bar::after{display:none}
.by{margin:0 0 3px;font-size:13px;color:var(--muted);max-width:none}
.tiles{display:flex;flex-wrap:wrap;gap:12px;margin:18px 0 4px}
.tile{flex:1 1 170px;background:var(--card);border-radius:6px;padding:10px 14px}
.tile b{display:block;font-size:20px;font-weight:600;white-space:nowrap}
.tile span{color:var(--muted);font-size:13px}
table{border-collapse:collapse;margin:8px 0;font-size:14px}
th{font-weight:600;text-align:left;color:var(--muted);font-size:13px}
th,td{padding:4px 18px 4px 0;border-bottom:1px solid var(--line);vertical-align:top}
td.n,th.n{text-align:right;white-space:nowrap}
th[scope=row]{color:var(--ink);font-size:14px}
.causes{width:100%}.causes td:nth-child(3){white-space:nowrap}
.scroll{overflow-x:auto}
#capture td{overflow-wrap:anywhere}
code{white-space:nowrap;font:12.5px/1.4 "Noto Sans Mono","Liberation Mono",Consolas,monospace;color:var(--muted)}
figure{margin:0;min-width:0}
figcaption{color:var(--muted);font-size:13px;line-height:1.4}
svg{display:block;width:100%;height:auto;overflow:visible;
font-family:"Noto Sans","Liberation Sans","Segoe UI",system-ui,Arial,sans-serif}
svg.marks{position:absolute;width:0;height:0}
.row{display:grid;gap:14px 20px;margin-top:12px}
.n1{grid-template-columns:minmax(0,1fr)}
.n2{grid-template-columns:repeat(2,minmax(0,1fr))}
.n3{grid-template-columns:repeat(3,minmax(0,1fr))}
.n4{grid-template-columns:repeat(4,minmax(0,1fr))}
.n5{grid-template-columns:repeat(6,minmax(0,1fr))}
.n5>*{grid-column:span 2}.n5>:nth-child(n+4){grid-column:span 3}
.wide{grid-template-columns:minmax(0,1.75fr) minmax(0,1fr);align-items:center}
.wide>section{align-self:start}
.legend{display:flex;flex-wrap:wrap;gap:2px 18px;font-size:13px;color:var(--muted);margin:8px 0 0;
padding:0;list-style:none}
.legend i{display:inline-block;width:18px;height:0;border-top:3px solid;margin-right:6px;
vertical-align:middle}
.legend i.dot{width:9px;height:9px;border:0;border-radius:5px;background:currentColor}
.legend i.ring{width:9px;height:9px;border:1.5px solid;border-radius:5px}
.legend i.dash{border-top:2px dashed}
.legend i.thick{border-top-width:8px}
.legend i.box{height:11px;border:0}
.legend i.box.before,.legend i.box.after{background:currentColor;opacity:.6}
.legend i.tick{width:0;height:14px;border:0;border-left:2px dashed var(--floor)}
.before{color:var(--before)}.after{color:var(--after)}.measured{color:var(--measured)}
.muted{color:var(--muted)}.floor{color:var(--floor)}.pale{color:var(--pale)}.second{color:var(--second)}
.finding{border:1px solid var(--line);border-radius:8px;padding:14px 18px 16px;margin:14px 0}
.finding p{margin:4px 0}
.finding h3>span:first-child{color:var(--muted);font-weight:400}
.two{display:grid;grid-template-columns:minmax(0,2fr) minmax(0,3fr);gap:4px 28px;align-items:start}
.two .row{margin-top:0}
.last{grid-template-columns:minmax(0,3fr) minmax(0,2fr);gap:0 40px}
.finding .tag{display:inline-block;border:1px solid var(--line);border-radius:10px;padding:0 9px;
font-size:12.5px;color:var(--muted);margin-left:8px;font-weight:400}
.rivals{background:var(--card);border-radius:6px;padding:8px 12px;margin:8px 0 0;font-size:14px;
max-width:none}
a{color:var(--after)}
footer{margin-top:36px;border-top:1px solid var(--line);padding-top:8px;color:var(--muted);
font-size:13px}
@media screen and (max-width:900px){.n3,.n4{grid-template-columns:repeat(2,minmax(0,1fr))}
.two,.wide,.last{grid-template-columns:minmax(0,1fr)}}
@media screen and (max-width:600px){main{padding:18px 14px 32px}h1{font-size:22px}
.n2,.n3,.n4,.n5,.line{grid-template-columns:minmax(0,1fr)}.n5>*,.n5>:nth-child(n+4){grid-column:auto}
.fill{width:calc(var(--w)*.58%)}.bar::after{left:calc(var(--noise)*.58%)}
.finding{padding:12px}th,td{padding-right:10px}.tile{flex-basis:140px}.tile b{white-space:normal}
#model thead{display:none}#model tr{display:grid;grid-template-columns:1fr auto auto 36px;gap:0 10px}
#model tr{border-bottom:1px solid var(--line)}#model th,#model td{border:0;padding:2px 0}
#model th{grid-column:1/-1}#model th:empty{display:none}#model td[colspan]{grid-column:1/-1}
.causes thead{display:none}.causes tr{display:block;border-bottom:1px solid var(--line);padding:6px 0}
.causes td{border:0;padding:1px 8px 1px 0}.causes td.n:first-child,.causes td:nth-child(2){display:inline}
.causes td:nth-child(n+3){display:block;text-align:left;white-space:normal}
.causes td[data-label]::before{content:attr(data-label);color:var(--muted);font-size:13px}
.w270 text{font-size:10px}.w480 text{font-size:13.5px}.w560 text,.w620 text{font-size:17px}
.w700 text{font-size:18px}}
@page{size:A4;margin:13mm 13mm}
@media print{body{font-size:9.5pt;line-height:1.4;background:#fff}main{max-width:none;padding:0}
h1{font-size:16pt}h2{font-size:12pt;margin-top:14pt;break-after:avoid}
h3,h2+.note,h2+.note+.legend{break-after:avoid}
.n3,.n4{gap:6pt 8pt}
.two{grid-template-columns:minmax(0,5fr) minmax(0,6fr);gap:4px 16px}
.last{display:block}p{break-inside:avoid}
.line{grid-template-columns:170px 1fr;padding:5pt 0}.fill{width:calc(var(--w)*.66%)}
.bar::after{left:calc(var(--noise)*.66%)}
figure,tr,.tile,.line,.legend,.rivals,.finding{break-inside:avoid}.legend{break-before:avoid}
.finding{padding:7pt 10pt 8pt;margin:8pt 0}th,td{padding-right:10px}
.tile,.rivals{background:none;border:1px solid var(--line)}
.note,figcaption,.legend,.over,.tile span,.by,.what span{font-size:8.5pt}
table,.rivals,th[scope=row],.bar>span{font-size:9pt}thead th{font-size:8.5pt}
.finding .tag{font-size:8pt}
.tiles{flex-wrap:nowrap;gap:6pt}.tile{flex:1 1 auto;padding:6pt 8pt}.tile b{font-size:12pt}
svg text{font-size:14px}.w270 text{font-size:12px}.n4 .w270 text,.two .w270 text{font-size:15px}
.w560 text,.w620 text,.w700 text,.w420 text{font-size:16px}
*{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)css";

} // namespace ada
