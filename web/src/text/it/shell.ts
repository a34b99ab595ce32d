import type { en, Translated } from "../en";

export const shell: Translated<typeof en.shell> = {
  home: "Livella, pagina iniziale",
  skip: "Vai al contenuto",
  places: "Navigazione principale",
  devices: "Dispositivi",
  alerts: "Avvisi",
  settings: "Impostazioni",
  account: "Profilo: {{name}}",
  sign_out: "Esci",
  not_signed_out: "L’accesso è ancora aperto",
  language: "Lingua",
  to_light: "Passa ai colori chiari",
  to_dark: "Passa ai colori scuri",
  role: {
    device: "Dispositivo",
    installer: "Installatore",
    manager: "Gestore della flotta",
    admin: "Amministratore",
  },
  live: {
    connecting: "Connessione…",
    live: "In diretta",
    reconnecting: "Riconnessione…",
    asleep: "In pausa",
  },
  lost: "connessione persa <ago />",
  this_page: "questa pagina",
  nowhere: "Questa pagina non esiste",
  to_devices: "All’elenco dei dispositivi",
  motto: "Com’è montata la scatola? Basta guidare.",
  key: "Chiave",
  key_about:
    "La fornisce l’amministratore; la prima viene stampata al primo avvio del servizio. La chiave di un dispositivo mostra quel dispositivo.",
  key_unknown: "Questa chiave non è nota. Controllare che sia stata copiata per intero.",
  show_key: "Mostra la chiave",
  sign_in: "Accedi",
};
