/** Move places apart until none is nearer to another than a distance, in their order, none beyond the end. */
export function apart(wanted: readonly number[], distance: number, end: number): number[] {
  const order = wanted.map((_, i) => i).sort((a, b) => (wanted[a] ?? 0) - (wanted[b] ?? 0));
  const places = [...wanted];
  order.forEach((i, rank) => {
    const before = order[rank - 1];
    if (before !== undefined) places[i] = Math.max(places[i] ?? 0, (places[before] ?? 0) + distance);
  });
  const beyond = Math.max(0, (places[order.at(-1) ?? 0] ?? 0) - end);
  return places.map((place) => place - beyond);
}
