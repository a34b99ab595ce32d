import { describe, expect, it } from "vitest";
import { filtersSet, fromAddress, toAddress, UNFILTERED } from "./filters";

const read = (address: string) => fromAddress(new URLSearchParams(address));

describe("filters in the address", () => {
  it("are the unresolved ones when it says nothing", () => expect(read("")).toEqual(UNFILTERED));

  it.each([
    "",
    "state=all",
    "state=open&kind=gps_lost&severity=critical&device=van%2F1+a&since=2025-11-01&until=2025-11-22",
    "kind=sensor_fault",
  ])("come back as they were: %s", (address) => {
    expect(toAddress(read(address)).toString()).toBe(address);
  });

  it("leaves out what is no filter", () => {
    expect(read("state=x&kind=y&severity=z&since=2025-13-01&until=tomorrow&id=7")).toEqual(UNFILTERED);
  });

  it("counts those besides the state", () => {
    expect(filtersSet(read("state=all"))).toBe(0);
    expect(filtersSet(read("state=all&kind=gps_lost&since=2025-11-01"))).toBe(2);
  });
});
