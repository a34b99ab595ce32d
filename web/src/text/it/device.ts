import type { en, Translated } from "../en";

export const device: Translated<typeof en.device> = {
  the_device: "il dispositivo",
  gone: "Il dispositivo {{id}} non esiste",

  action: {
    motion: "Moto",
    print: "Stampa il certificato",
    refit: "Dispositivo rimontato",
    more: "Altro",
    edit: "Modifica nome, veicolo e note",
    new_key: "Nuova chiave del dispositivo",
    remove: "Elimina il dispositivo",
  },

  live: {
    region: "La calibrazione adesso",
    stages: "Fasi",
    step: { done: " (fatto)", current: " (adesso)", ahead: " (non ancora)" },
    status: "Fase: {{stage}}. {{say}}",
    also: "Serve anche",
  },

  now: {
    silent: "Accendere il quadro e guidare: la calibrazione prosegue con i prossimi dati.",
    data: "In attesa di dati: accendere il dispositivo e controllare che possa trasmettere.",
    data_again: "Guidare: la calibrazione comincia con i prossimi dati.",
    gps_fix: "Guidare, o sostare, a cielo aperto finché il GPS non ha la posizione.",
    motion: "Partire: il veicolo deve muoversi.",
    turn: "Fare qualche curva, a sinistra e a destra.",
    accelerate_or_brake: "Frenare con decisione una o due volte su una strada diritta.",
    time: "Continuare a guidare normalmente.",
    verifying: "Continuare a guidare normalmente: il risultato è in prova.",
    confirmed: "Il montaggio è confermato. Non occorre fare altro.",
  },

  figure: {
    list: "Che cosa trasmette il dispositivo",
    gps: "Posizione GPS",
    speed: "Velocità",
    rate: "Campioni",
    gyroscope: "Giroscopio",
    last: "Ultimi dati",
    seconds_ago: "{{seconds}} s fa",
    as_of: "alle {{time}}",
  },

  trouble: {
    list: "Che cosa non va",
    silent: "Il dispositivo tace: ultimi dati {{ago}}",
    silent_do:
      "Accendere il quadro. Se non arriva nulla, controllare l’alimentazione, la SIM e la chiave del dispositivo.",
    no_fix: "Il ricevitore GPS non ha la posizione",
    no_fix_do:
      "Portarsi all’aperto e attendere due minuti. Se la posizione non arriva, controllare l’antenna e il suo cavo.",
    sample_rate: "Solo {{rate}} campioni al secondo",
    sample_rate_do:
      "Impostare il dispositivo su almeno {{least}} campioni al secondo; da 50 a 100 vanno bene.",
    fix_rate: "Solo {{rate}} posizioni GPS al secondo",
    fix_rate_do:
      "Impostare il ricevitore su almeno una posizione al secondo; da 5 a 10 abbreviano la calibrazione.",
    rejected: "Il {{share}} delle letture non viene usato",
    duplicate_time:
      "Più campioni portano lo stesso tempo. Controllare l’orologio del dispositivo e come numera i campioni.",
    before_previous_sample:
      "I campioni arrivano nell’ordine sbagliato. Controllare che il dispositivo li trasmetta nell’ordine dei loro tempi.",
    fix_without_velocity:
      "Le posizioni GPS arrivano senza velocità e rotta. Fare in modo che il dispositivo trasmetta entrambe, oppure la posizione più spesso.",
    fix_implausible:
      "Le posizioni GPS saltano, come accade fra muri alti o sotto un tetto. Portarsi all’aperto; controllare dove si trova l’antenna.",
    other_reason: "Il servizio indica come motivo: {{reason}}.",
    failed: "La prova su strada non è riuscita",
    failed_do: "Continuare a guidare. Il risultato continua a migliorare e la prova si ripete da sola.",
    suspect: "Il dispositivo sembra essersi spostato",
    suspect_do:
      "Il montaggio confermato il {{time}} resta, ma non è più affidabile. Controllare che il dispositivo sia ben fissato, poi guidare: un nuovo montaggio verrà confermato allo stesso modo.",
    stalled: "Ci vuole più tempo del solito",
    stalled_do:
      "Frenare con decisione e fare qualche curva. Se non basta, controllare che il dispositivo sia ben fissato e che l’antenna veda il cielo.",
  },

  level: {
    offer: "Il veicolo è fermo in piano",
    ask: "Il veicolo è fermo in piano?",
    about:
      "In piano la gravità mostra subito come è inclinato il dispositivo. Da che parte guarda richiede ancora una frenata o una curva. Confermare solo mentre il veicolo è fermo su un pavimento in piano e nessuno sale o scende.",
    yes: "È in piano",
    taken: "Si è tenuto conto del piano",
    taken_next: "Ora partire, frenare e fare una curva.",
    refused: "Non è stato accettato",
  },

  sure: {
    title: "Quanto è sicuro",
    below: "sotto il limite",
    about_x: "attorno all’asse longitudinale",
    about_y: "attorno all’asse trasversale",
    about_z: "attorno all’asse verticale",
    plus_minus: "± {{degrees}}",
    note: "Una deviazione standard. Le tacche indicano ciò che serve per la prova su strada.",
    chart: "Incertezza nel tempo",
    chart_says:
      "Incertezza nel tempo; ultimi valori: rollio {{roll}}, beccheggio {{pitch}}, imbardata {{yaw}}",
    limit: "limite",
    the_chart: "il grafico",
    empty: "Ancora nulla di noto",
    empty_do:
      "Appena il veicolo si muove, qui compaiono tre curve che scendono. Sotto il limite la prova su strada comincia da sola.",
  },

  test: {
    title: "Prova su strada",
    passed: "Superata",
    failed: "Non superata",
    running: "In corso",
    none: "Nessuna prova in corso.",
    begins: "Comincia da sola quando gli angoli si sono assestati e dura {{seconds}} s di guida.",
    how: "La velocità che risulta dal sensore viene confrontata con quella del GPS.",
    left_word: "mancano",
    left_says: "Mancano {{seconds}} s di guida",
    goes_on: "Prosegue finché il risultato è abbastanza sicuro, al massimo per altri {{seconds}} s.",
    error: "Errore di velocità {{error}} km/h, al massimo {{limit}} km/h",
    within: "entro il limite",
    beyond: "oltre il limite",
    failed_why: "Le velocità erano troppo diverse. Continuare a guidare: la prova si ripete da sola.",
    gps: "GPS",
    sensor: "Sensore",
    the_chart: "il grafico delle velocità",
    axis: "Velocità in km/h",
    chart_says:
      "Velocità in {{seconds}} s di guida: GPS da {{gps_first}} a {{gps_last}} km/h, sensore da {{sensor_first}} a {{sensor_last}} km/h; distanza massima {{gap}} km/h",
  },

  mounting: {
    title: "Montaggio",
    empty: "Non ancora noto",
    empty_do: "Basta guidare un poco: si mostra da solo.",
    so_far: "Finora, non confermato",
    suspect: "Dubbio",
    confirmed: "Confermato <time />",
  },

  picture: {
    about: "Disegno del veicolo; le frecce della tastiera lo girano",
    views: "Vista del veicolo",
    corner: "Angolo",
    above: "Alto",
    left: "Sinistra",
    behind: "Dietro",
    from_above: "Dall’alto",
    from_left: "Da sinistra",
    from_behind: "Da dietro",
    forward: "avanti",
    leftward: "sinistra",
  },

  numbers: {
    title: "Numeri",
    quaternion: "Quaternione q_vs: w, x, y, z",
    note: "Porta le letture del sensore negli assi del veicolo, f_v = R(q_vs) f_s. Assi del veicolo: x in avanti, y a sinistra, z in alto (ISO 8855).",
    matrix: "Matrice R(q_vs)",
    of_device: "disp. {{axis}}",
    forward: "avanti",
    left: "sinistra",
    up: "alto",
  },

  certificate: {
    title: "Certificato di installazione",
    device: "Dispositivo",
    vehicle: "Veicolo",
    stage: "Fase",
    confirmed: "Confermato il",
    not_yet: "non ancora",
    last_data: "Ultimi dati",
    notes: "Note",
    printed: "Stampato il",
    suspect: "Dubbio: il dispositivo sembra essersi spostato",
    mounting: "Montaggio",
    mounting_so_far: "Montaggio finora, non confermato",
    nothing: "Ancora nessun montaggio è noto.",
    angles: "Angoli in gradi (ISO 8855), con una deviazione standard",
    quaternion: "Quaternione q_vs (w, x, y, z): {{quaternion}}",
    test: "Prova su strada",
    test_passed:
      "Superata: dopo {{seconds}} s di guida la velocità del sensore si scostava di {{error}} km/h da quella del GPS; sono ammessi {{limit}} km/h.",
    no_test: "Nessuna prova su strada riguarda ancora questo montaggio.",
    page: "Pagina di questo dispositivo",
    installer: "Installato da",
    signature: "Data e firma",
  },

  refit: {
    ask: "Il dispositivo è stato rimontato?",
    begins: "Il montaggio in vigore finisce e la calibrazione comincia con il prossimo viaggio.",
    stays: "Restano i montaggi precedenti, la storia degli angoli e gli avvisi.",
    go: "Ricomincia",
    failed: "La calibrazione non è ricominciata",
  },

  edit: {
    title: "Modifica il dispositivo",
    name: "Nome",
    vehicle: "Veicolo",
    vehicle_example: "Marca, modello, targa",
    notes: "Note",
    save: "Salva",
    failed: "Le modifiche non sono state salvate",
  },

  key: {
    ask: "Creare una nuova chiave?",
    about:
      "La chiave che il dispositivo ha ora smette subito di valere. Finché non riceve quella nuova, nulla di ciò che trasmette viene accettato.",
    go: "Crea la chiave",
    failed: "La nuova chiave non è stata creata",
    made: "La nuova chiave",
    once: "Questa chiave si vede solo adesso",
    once_do: "Inserirla nel dispositivo, o conservarla al sicuro.",
    label: "Chiave di {{name}}",
    code: "Codice QR della chiave",
  },

  removal: {
    title: "Eliminare il dispositivo?",
    about: "La chiave, i montaggi, la storia e gli avvisi vengono cancellati. Non si può tornare indietro.",
    type: "Scrivere {{name}} per confermare",
    go: "Elimina per sempre",
    failed: "Il dispositivo non è stato eliminato",
  },
};
