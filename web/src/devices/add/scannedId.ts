/** What a code on a device says, as the id of a device: taken as it is, or explained. Nothing is changed silently. */
const ID = /^[A-Za-z0-9][A-Za-z0-9._:-]{0,63}$/;
const LONGEST = 64;
const ADDRESS = /^([a-z][a-z0-9+.-]*:\/\/|www\.)/i;
const OWN_SCHEME = /^livella:/i;
/** Barcodes of shops: they name the product, not the piece. */
const OF_PRODUCTS = /^(ean|upc)_/;

export interface Code {
  text: string;
  /** as the Barcode Detection API names it, such as qr_code */
  format: string;
}

export interface Found {
  id: string;
  isProductCode: boolean;
}

export interface Unusable {
  id: null;
  text: string;
  reason: Reason;
  characters?: string[];
}

export type Reason = "empty" | "address" | "record" | "long" | "begin" | "characters";

/** `host` is where this page came from: codes of its own devices are addresses there. */
export function scannedId({ text, format }: Code, host: string): Found | Unusable {
  const trimmed = text.trim();
  const own = idOfAddress(trimmed, host);
  const id = own ?? trimmed.replace(OWN_SCHEME, "");
  const isElsewhere = own === undefined && ADDRESS.test(trimmed);
  if (ID.test(id) && !isElsewhere) return { id, isProductCode: OF_PRODUCTS.test(format) };
  return { id: null, text: trimmed, ...whyNot(trimmed, id) };
}

/** The id in the address of one of this service's devices, by whatever port and protocol it was reached. */
function idOfAddress(text: string, host: string): string | undefined {
  try {
    const { hostname, pathname } = new URL(text);
    const last = /\/devices\/([^/]+)\/?$/.exec(pathname)?.[1];
    return hostname === host && last ? decodeURIComponent(last) : undefined;
  } catch {
    return undefined; // no address
  }
}

function whyNot(text: string, id: string): { reason: Reason; characters?: string[] } {
  if (id === "") return { reason: "empty" };
  if (ADDRESS.test(text)) return { reason: "address" };
  if (/^[[{]/.test(text)) return { reason: "record" };
  const characters = [...new Set(id.match(/[^A-Za-z0-9._:-]/gu))];
  if (characters.length > 0) return { reason: "characters", characters };
  return { reason: id.length > LONGEST ? "long" : "begin" };
}
