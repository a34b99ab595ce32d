import type { en, Translated } from "../en";

export const mounting: Translated<typeof en.mounting> = {
  straight: "Il dispositivo è diritto: i suoi assi sono quelli del veicolo.",
  turned: "Il dispositivo {{how}}.",
  on_end: {
    down: "Il dispositivo sta in verticale: il suo asse x punta esattamente in basso.",
    up: "Il dispositivo sta in verticale: il suo asse x punta esattamente in alto.",
    almost_down: "Il dispositivo sta in verticale: il suo asse x punta quasi esattamente in basso.",
    almost_up: "Il dispositivo sta in verticale: il suo asse x punta quasi esattamente in alto.",
  },
  not_unique:
    "Vicino a un beccheggio di ±90° imbardata e rollio non sono univoci; il disegno e il quaternione sì.",
  good_to: "Preciso a {{degrees}}.",
  yaw: {
    left: "è girato di {{degrees}} a sinistra",
    right: "è girato di {{degrees}} a destra",
    backward: "guarda all’indietro",
    backward_too: "{{turned}} (guarda all’indietro)",
  },
  pitch: {
    down: "ha il davanti inclinato di {{degrees}} in basso",
    up: "ha il davanti inclinato di {{degrees}} in alto",
  },
  roll: {
    right: "è coricato di {{degrees}} sul lato destro",
    left: "è coricato di {{degrees}} sul lato sinistro",
    over: "è capovolto",
    over_too: "{{rolled}} (capovolto)",
  },
  axes: "Il suo asse x punta {{x}}, l’asse y {{y}} e l’asse z {{z}}.",
  direction: {
    forward: "in avanti",
    backward: "all’indietro",
    left: "a sinistra",
    right: "a destra",
    up: "in alto",
    down: "in basso",
  },
};
