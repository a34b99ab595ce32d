import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { setLanguage, t } from ".";
import { en } from "./en";
import { it as italian } from "./it";

interface Tree {
  readonly [name: string]: string | Tree;
}

function flat(tree: Tree, at = ""): Map<string, string> {
  const entries = Object.entries(tree).flatMap(([name, value]) =>
    typeof value === "string" ? [[at + name, value] as const] : [...flat(value, `${at}${name}.`)],
  );
  return new Map(entries);
}

/** What stands in a text for something else: {{name}} and <tag>. */
const places = (text: string) =>
  [...text.matchAll(/\{\{.*?\}\}|<\/?\w+ ?\/?>/g)].map(([place]) => place).sort();

/** The same in both languages: names, units, words that Italian has taken over. */
const SAME = /^(–|No|Password|Webhook|API|Online|CSV|GPS|\d+ h|[^a-z]*|.*\{\{.*\}\}[^a-z]*)$/i;

const english = flat(en);
const translated = flat(italian);

describe("Italian", () => {
  it("has every text", () => expect([...translated.keys()].sort()).toEqual([...english.keys()].sort()));

  it.each([...english])("keeps the places of %s", (name, text) => {
    expect(places(translated.get(name) ?? "")).toEqual(places(text));
  });

  it.each([...english].filter(([, text]) => !SAME.test(text)))("is translated: %s", (name, text) => {
    expect(translated.get(name)).not.toBe(text);
  });
});

describe("a switch", () => {
  beforeAll(() => setLanguage("it"));
  afterAll(() => setLanguage("en"));

  it("changes what is said", () => expect(t("common.stage.confirmed")).toBe("Confermato"));
});
