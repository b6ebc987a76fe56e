// Curves beside the bodies, with a mark that says where one is.

import {
  Chart,
  Legend,
  LinearScale,
  LineElement,
  PointElement,
  ScatterController,
  Title,
  Tooltip,
} from "chart.js";

Chart.register(Legend, LinearScale, LineElement, PointElement, ScatterController, Title, Tooltip);

/** A diagram in an element of the page; the answer's `show(s)` moves its mark to state s. */
export function diagram(element, given) {
  const canvas = document.createElement("canvas");
  const mark = document.createElement("div");
  mark.className = given.at_y ? "mark point" : "mark line";
  element.append(canvas, mark);
  const chart = new Chart(canvas, {
    type: "scatter",
    data: { datasets: given.curves.map(dataset) },
    options: {
      animation: false,
      maintainAspectRatio: false,
      interaction: { mode: "nearest", intersect: false },
      plugins: {
        title: { display: true, text: given.title, color: "#333333" },
        legend: { display: given.curves.length > 1, labels: { boxHeight: 1 } },
      },
      scales: { x: axis(given.x_label), y: axis(given.y_label) },
    },
  });
  let now = 0;
  function show(s) {
    now = s;
    const { left, right, top, bottom } = chart.chartArea;
    const x = chart.scales.x.getPixelForValue(valueAt(given.at_x, s));
    mark.style.left = `${Math.min(Math.max(x, left), right)}px`;
    mark.style.top = `${given.at_y ? chart.scales.y.getPixelForValue(valueAt(given.at_y, s)) : top}px`;
    mark.style.height = given.at_y ? "" : `${bottom - top}px`;
  }
  new ResizeObserver(() => requestAnimationFrame(() => show(now))).observe(element);
  return { show };
}

/** A value between two states that were kept. */
export function valueAt(values, s) {
  const k = Math.min(Math.floor(s), values.length - 1);
  const next = Math.min(k + 1, values.length - 1);
  return values[k] + (s - k) * (values[next] - values[k]);
}

const dataset = (curve) => ({
  label: curve.label,
  data: curve.x.map((x, i) => ({ x, y: curve.y[i] })),
  borderColor: curve.colour,
  borderWidth: 1.5,
  borderDash: curve.dashed ? [5, 4] : [],
  showLine: true,
  pointRadius: 0,
  pointHoverRadius: 3,
});

const axis = (text) => ({
  title: { display: true, text },
  ticks: { maxTicksLimit: 7, callback: (value) => String(Number(value.toPrecision(4))) },
});
