/**
 * What the page says, in the reader's language. `t` gives a text. Those that every page needs are there in English from the
 * beginning; those of a room come with it, in the language that is read.
 */
import i18next, { type TFunction } from "i18next";
import { useSyncExternalStore } from "react";
import { initReactI18next } from "react-i18next";
import type { en } from "./en";
import { common } from "./en/common";
import { shell } from "./en/shell";

export { Trans } from "react-i18next";

export const LANGUAGES = { en: "English", it: "Italiano" } as const;
export type Language = keyof typeof LANGUAGES;

const STORED = "livella-language";
/** Used where the browser names no region of the language. */
const REGION: Record<Language, string> = { en: "en-GB", it: "it-IT" };

export const t: TFunction = i18next.t;

export type Room = keyof typeof en;

const files = import.meta.glob<Record<string, object>>(["./en/*.ts", "./it/*.ts", "!./*/index.ts"]);
/** Whose texts are there, or on their way. */
const opened = new Set<Room>(["common", "shell"]);

/** Begin in a language: unless given, the one chosen before, else the first of the browser's that there is. */
export async function startText(first: Language = chosen()): Promise<void> {
  i18next.use(initReactI18next);
  await i18next.init({
    lng: "en",
    fallbackLng: "en",
    resources: { en: { translation: { common, shell } } },
    interpolation: { escapeValue: false },
  });
  await setLanguage(first);
}

/** Bring the texts of rooms, in the language that is read. */
export async function openRooms(...rooms: Room[]): Promise<void> {
  for (const room of rooms) opened.add(room);
  await Promise.all(rooms.map((room) => bring(language(), room)));
}

async function bring(tongue: Language, room: Room): Promise<void> {
  if (i18next.exists(room, { lng: tongue, fallbackLng: tongue, returnObjects: true })) return;
  const file = await files[`./${tongue}/${room}.ts`]?.();
  i18next.addResourceBundle(tongue, "translation", { [room]: file?.[room] }, true);
}

function chosen(): Language {
  const wanted = [localStorage.getItem(STORED) ?? "", ...navigator.languages];
  return wanted.map((tag) => tag.slice(0, 2)).find(isLanguage) ?? "en";
}

function isLanguage(tag: string): tag is Language {
  return tag in LANGUAGES;
}

export function language(): Language {
  return isLanguage(i18next.language) ? i18next.language : "en";
}

/** Switch; whoever uses `useLanguage` is drawn anew. */
export async function setLanguage(next: Language): Promise<void> {
  await Promise.all([...opened].map((room) => bring(next, room)));
  await i18next.changeLanguage(next);
  if (typeof document !== "undefined") document.documentElement.lang = next;
}

/** Switch, and stay so on this browser. */
export async function chooseLanguage(next: Language): Promise<void> {
  localStorage.setItem(STORED, next);
  await setLanguage(next);
}

export function useLanguage(): Language {
  return useSyncExternalStore(subscribe, language);
}

function subscribe(listener: () => void): () => void {
  i18next.on("languageChanged", listener);
  return () => i18next.off("languageChanged", listener);
}

/** The reader's own region where it speaks the page's language: it decides how numbers and times are written. */
export function locale(): string {
  const now = language();
  const known = typeof navigator === "undefined" ? [] : (navigator.languages ?? []);
  return known.find((tag) => tag.startsWith(`${now}-`)) ?? REGION[now];
}
