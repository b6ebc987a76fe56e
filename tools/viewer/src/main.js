// A page of fem_lie: bodies that move, a slider, diagrams that run along.

import { drawn } from "./bodies.js";
import { diagram, valueAt } from "./diagram.js";
import { stage } from "./stage.js";

const page = JSON.parse(document.getElementById("page").textContent);
const at = (name) => document.getElementById(name);

const diagrams = page.diagrams.map((given) => {
  const element = document.createElement("div");
  element.className = "diagram";
  at("diagrams").append(element);
  return diagram(element, given);
});
if (!diagrams.length) at("diagrams").remove();
const { scene, draw } = stage(at("stage"), page.axes);
const bodies = drawn(page);
scene.add(...bodies.objects);
if (page.colours) legend(page.colours);

const last = page.states.length - 1;
let now = 0;
let playing = false;
let before = 0;

/** Show state s, a real number between 0 and the last. */
function show(s) {
  now = Math.min(Math.max(s, 0), last);
  bodies.show(now);
  diagrams.forEach((one) => one.show(now));
  at("slider").value = now;
  const value = Number(valueAt(page.states, now).toPrecision(4));
  at("state").textContent = `${page.state_label} ${value}${page.state_unit}`;
  draw();
}

function play(run) {
  playing = run && last > 0;
  at("play").textContent = playing ? "❚❚" : "▶";
  at("play").ariaLabel = playing ? "pause" : "play";
  before = performance.now();
  if (playing) requestAnimationFrame(step);
}

function step(time) {
  if (!playing) return;
  const passed = Math.max(0, time - before) / 1000;
  before = time;
  const s = now + (passed * last * Number(at("speed").value)) / page.seconds;
  show(s > last ? 0 : s);
  requestAnimationFrame(step);
}

function legend(scale) {
  const bar = at("legend");
  bar.hidden = false;
  bar.querySelector(".name").textContent = scale.label;
  bar.querySelector(".bar").style.background = `linear-gradient(to top, ${scale.names.join(",")})`;
  bar.querySelector(".high").textContent = scale.high;
  bar.querySelector(".low").textContent = scale.low;
}

at("slider").max = last;
at("slider").addEventListener("input", (event) => {
  play(false);
  show(Number(event.target.value));
});
at("play").addEventListener("click", () => play(!playing));
document.addEventListener("keydown", (event) => {
  const moves = { ArrowLeft: -1, ArrowRight: 1 };
  if (["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
  if (event.key === " ") play(!playing);
  else if (event.key in moves) show(Math.round(now) + moves[event.key]);
  else return;
  event.preventDefault();
});

// page.html#0.5 opens in the middle of the states and waits
const asked = parseFloat(location.hash.slice(1));
show(Number.isFinite(asked) ? asked * last : 0);
play(page.plays && !Number.isFinite(asked));
