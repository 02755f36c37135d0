/* Distributions of the scores in a page: one chart for each. Data: #distribution-data. */
"use strict";
(() => {
  const box = document.getElementById("distribution-charts");
  if (!box) return;
  document.documentElement.classList.add("scripts");
  const data = JSON.parse(document.getElementById("distribution-data").textContent);
  const charts = data.spreads.map(spread => {
    const laws = spread.laws.filter(law => law.x.length);
    const description = {
      title: spread.title + (spread.allowed && `, allowed ${spread.allowed}`), unit: spread.unit, x: {label: spread.title, unit: spread.unit}, height: 200, y: [0, 102],
      series: laws.map(law => ({label: law.label, unit: "% of the runs", colour: law.colour, dash: law.dash, width: law.width, step: true})),
      markers: spread.limits.map(limit => ({at: limit, text: `allowed ${spread.allowed} ${spread.unit}`})),
    };
    const tables = laws.map(law => [law.x, law.y]);
    return tables.length ? railhilCharts.chart(box, description, tables.length > 1 ? railhilCharts.join(tables) : tables[0]) : null;
  });
  window.railhilDistributions = charts;
})();
