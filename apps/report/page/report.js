// SPDX-License-Identifier: Apache-2.0
// Draws the plots of report.html from the JSON in the page; all of them zoom together and show the phases of the path.
(function () {
  'use strict';
  if (typeof Dygraph === 'undefined') return;
  document.documentElement.classList.add('scripted');
  const data = JSON.parse(document.getElementById('data').textContent);
  const style = getComputedStyle(document.documentElement);
  const color = function (name) { return style.getPropertyValue(name).trim(); };
  const seriesColors = {x: '#c2554d', y: '#4f9a54', z: '#8a6bbf', magnitude: color('--accent')};
  const graphs = [];
  let busy = false;

  // Every other phase is shaded; each is named at its top as long as there is room.
  function drawPhases(canvas, area, graph) {
    canvas.save();
    canvas.font = '12px system-ui, sans-serif';
    canvas.textBaseline = 'top';
    data.phases.forEach(function (phase, i) {
      const left = Math.max(graph.toDomXCoord(phase[1]), area.x);
      const right = Math.min(graph.toDomXCoord(phase[2]), area.x + area.w);
      if (right <= left) return;
      canvas.fillStyle = i % 2 ? 'rgba(128,140,152,0.16)' : 'rgba(128,140,152,0.05)';
      canvas.fillRect(left, area.y, right - left, area.h);
      canvas.fillStyle = color('--soft');
      if (canvas.measureText(phase[0]).width + 10 < right - left) canvas.fillText(phase[0], left + 5, area.y + 3);
    });
    canvas.restore();
  }

  function zoomOthers(graph, initial) {
    if (busy || initial) return;
    busy = true;
    const range = graph.xAxisRange();
    graphs.forEach(function (other) { if (other !== graph) other.updateOptions({dateWindow: range}); });
    busy = false;
  }

  data.plots.forEach(function (plot) {
    graphs.push(new Dygraph(document.getElementById(plot.id), plot.rows, {
      labels: ['time [s]'].concat(plot.labels),
      colors: plot.labels.map(function (label) { return seriesColors[label] || color('--accent'); }),
      series: {magnitude: {strokeWidth: 2}},
      strokeWidth: 1.2, animatedZooms: false, includeZero: true, legend: 'always', labelsSeparateLines: false,
      labelsDiv: document.getElementById(plot.id + '-legend'),
      axisLineColor: color('--line'), gridLineColor: color('--line'), axisLabelFontSize: 12, rightGap: 8,
      axes: {x: {axisLabelFormatter: function (t) { return +t.toFixed(4) + ' s'; },
                 valueFormatter: function (t) { return t.toFixed(4) + ' s'; }},
             y: {axisLabelWidth: 56}},
      underlayCallback: drawPhases, drawCallback: zoomOthers
    }));
  });
}());
