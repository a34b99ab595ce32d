import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Pace } from "./pace";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

/** What reads for so many ms, and what it was asked. */
function paced(ms: number) {
  const times: number[] = [];
  const onIdle = vi.fn();
  const act = async () => {
    times.push(performance.now());
    await new Promise((done) => setTimeout(done, ms));
  };
  return { pace: new Pace(act, onIdle), times, onIdle };
}

it("does at once, and once, what is asked many times at once", async () => {
  const { pace, times, onIdle } = paced(10);
  for (let i = 0; i < 5; i++) pace.soon();
  await vi.advanceTimersByTimeAsync(1000);
  expect(times).toHaveLength(1);
  expect(onIdle).not.toHaveBeenCalled();
  await vi.advanceTimersByTimeAsync(2000);
  expect(times).toHaveLength(1);
  expect(onIdle).toHaveBeenCalledOnce();
});

it("does not forget what is asked while it reads or rests", async () => {
  const { pace, times } = paced(10);
  pace.soon();
  await vi.advanceTimersByTimeAsync(5);
  pace.soon();
  await vi.advanceTimersByTimeAsync(2100);
  expect(times).toHaveLength(2);
});

it("rests longer after what takes long", async () => {
  const { pace, times } = paced(3000);
  pace.soon();
  await vi.advanceTimersByTimeAsync(100);
  pace.soon();
  await vi.advanceTimersByTimeAsync(3000 + 4 * 3000 - 200);
  expect(times).toHaveLength(1);
  await vi.advanceTimersByTimeAsync(200);
  expect(times).toHaveLength(2);
});

it("does nothing more when stopped, even while it reads", async () => {
  const { pace, times } = paced(10);
  pace.soon();
  await vi.advanceTimersByTimeAsync(5);
  pace.soon();
  pace.stop();
  await vi.advanceTimersByTimeAsync(60_000);
  expect(times).toHaveLength(1);
});
