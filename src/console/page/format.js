// Numbers and times as the page writes them.

const kMissing = '–';
const kMinus = '−';

/// `digits` after the point; a dash where nothing is known.
export function number(value, digits = 0) {
  if (value === null || value === undefined || !Number.isFinite(value)) return kMissing;
  const text = Math.abs(value).toFixed(digits);
  return value < 0 && Number(text) !== 0 ? kMinus + text : text;
}

export const with_unit = (value, digits, unit) => `${number(value, digits)} ${unit}`;

/// "8.2 s", "1 min 20 s", "2 h 5 min".
export function duration(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return kMissing;
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${Math.floor(seconds % 60)} s`;
  return `${Math.floor(seconds / 3600)} h ${Math.floor((seconds % 3600) / 60)} min`;
}

/// The time of day here, of a time in UTC.
export function clock(utc) {
  const time = new Date(utc);
  return Number.isNaN(time.getTime()) ? String(utc ?? '') : time.toLocaleTimeString('en-GB');
}

export const capital = text => text.charAt(0).toUpperCase() + text.slice(1);
