/** Do the same to many things, a few at once. What fails does not keep the others from being done. */
export type Outcome<T, R> = { item: T; done: true; value: R } | { item: T; done: false; error: Error };

export async function each<T, R>(
  items: readonly T[],
  atOnce: number,
  task: (item: T) => Promise<R>,
): Promise<Outcome<T, R>[]> {
  const outcomes: Outcome<T, R>[] = [];
  let next = 0;
  const work = async () => {
    for (let i = next++; i < items.length; i = next++) outcomes[i] = await tried(items[i] as T, task);
  };
  await Promise.all(Array.from({ length: Math.min(atOnce, items.length) }, work));
  return outcomes;
}

async function tried<T, R>(item: T, task: (item: T) => Promise<R>): Promise<Outcome<T, R>> {
  try {
    return { item, done: true, value: await task(item) };
  } catch (error) {
    return { item, done: false, error: error instanceof Error ? error : new Error(String(error)) };
  }
}
