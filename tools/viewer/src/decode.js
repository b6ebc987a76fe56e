// Arrays that travel as base64, and a state between two that were kept.

const KINDS = { u1: Uint8Array, i2: Int16Array, u4: Uint32Array, f4: Float32Array };

/** A typed array from {kind, data}. */
export function decode(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  return new KINDS[packed.kind](bytes.buffer);
}

/** Write state `s`, a real number, of a series of `count` numbers each into `out`. */
export function between(series, count, s, scale, out) {
  const states = series.length / count;
  const first = Math.min(Math.floor(s), states - 1);
  const second = Math.min(first + 1, states - 1);
  const part = s - first;
  for (let i = 0, a = first * count, b = second * count; i < count; i++, a++, b++) {
    out[i] = scale * (series[a] + part * (series[b] - series[a]));
  }
}
