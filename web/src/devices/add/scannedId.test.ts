import { describe, expect, it } from "vitest";
import { scannedId } from "./scannedId";

const HOST = "fleet.example";
const scan = (text: string, format = "qr_code") => scannedId({ text, format }, HOST);

describe("a code that is a device id", () => {
  it.each([
    ["van-7", "van-7"],
    ["356938035643809", "356938035643809"],
    ["AB:CD:EF:01.2_3", "AB:CD:EF:01.2_3"],
    ["  van-7\r\n", "van-7"],
    ["livella:van-7", "van-7"],
    ["LIVELLA:VAN-7", "VAN-7"],
    ["https://fleet.example/devices/van-7", "van-7"],
    ["https://fleet.example/devices/a%3Ab", "a:b"],
    ["http://fleet.example:8000/devices/van-7/?from=label#x", "van-7"],
    ["https://fleet.example/livella/devices/van-7", "van-7"],
    ["x".repeat(64), "x".repeat(64)],
  ])("%s is %s", (text, id) => expect(scan(text)).toEqual({ id, isProductCode: false }));

  it.each(["ean_13", "ean_8", "upc_a"])("of a product is told apart: %s", (format) =>
    expect(scan("4006381333931", format)).toEqual({ id: "4006381333931", isProductCode: true }),
  );
});

describe("a code that is something else is explained", () => {
  it.each([
    ["", "empty"],
    [" \n", "empty"],
    ["livella:", "empty"],
    ["https://shop.example/devices/van-7", "address"],
    ["https://fleet.example/alerts", "address"],
    ["https://fleet.example/devices/", "address"],
    ["https://fleet.example/devices/a/b", "address"],
    ["https://fleet.example/devices/%E0%A4%A", "address"],
    ["https://fleet.example/devices/van%207", "address"],
    ["www.maker.example", "address"],
    ['{"id":"van-7"}', "record"],
    ['["van-7"]', "record"],
    ["x".repeat(65), "long"],
    ["-van", "begin"],
    [".", "begin"],
  ])("%s: %s", (text, reason) => expect(scan(text)).toMatchObject({ id: null, reason, text: text.trim() }));

  it.each([
    ["van 7", [" "]],
    ["S/N 12/34", ["/", " "]],
    ["WIFI:S:net;T:WPA;;", [";"]],
    ["furgone-è🚚", ["è", "🚚"]],
    ["livella:van 7", [" "]],
    ["a\nb", ["\n"]],
  ])("%s has characters that an id may not have", (text, characters) =>
    expect(scan(text)).toMatchObject({ id: null, reason: "characters", characters }),
  );
});
