// The texts in sight whose contrast to what they stand on (WCAG 2.2) is below arguments[0].
const parse = text => { const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number); return [r, g, b, a]; };
const over = ([r, g, b, a], under) => [r, g, b].map((part, i) => part * a + under[i] * (1 - a));
const ground = element => {
  const colours = [];
  for (let each = element; each; each = each.parentElement) {
    const colour = parse(getComputedStyle(each).backgroundColor);
    colours.push(colour);
    if (colour[3] === 1) break;
  }
  return colours.reverse().reduce((under, colour) => over(colour, under), [255, 255, 255]);
};
const light = colour => {
  const [r, g, b] = colour.map(part => (part /= 255) <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const found = [];
for (const element of document.body.querySelectorAll('*')) {
  if (!element.checkVisibility() || ![...element.childNodes].some(node => node.nodeType === 3 && node.data.trim())) continue;
  const style = getComputedStyle(element), under = ground(element);
  const colour = parse(style.webkitTextFillColor);
  let opacity = 1;
  for (let each = element; each; each = each.parentElement) opacity *= Number(getComputedStyle(each).opacity);
  colour[3] *= opacity;
  const [low, high] = [light(over(colour, under)), light(under)].sort((a, b) => a - b);
  const ratio = (high + 0.05) / (low + 0.05);
  if (ratio < arguments[0]) found.push(`${element.id || element.tagName}.${element.className} ${element.textContent.trim().slice(0, 30)}: ${ratio.toFixed(2)} ${style.color} on ${under.map(Math.round)}`);
}
return found;
