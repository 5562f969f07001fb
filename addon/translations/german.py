"""German."""

from __future__ import annotations

TEXTS: dict[str, str] = {
    # Names of the modifiers stay as they are.
    "Turgor Volume": "Turgor Volume",
    "Turgor Spine": "Turgor Spine",
    # Operators
    "Keep the exact volume of the selected meshes while their armature bends them": (
        "Den gewählten Netzen ihr genaues Volumen erhalten, während ihre Armatur sie biegt"
    ),
    "Rebind": "Neu binden",
    "Read the mesh, its weights and its armature again; settings of joints stay": (
        "Netz, Gewichte und Armatur neu lesen; die Einstellungen der Gelenke bleiben"
    ),
    "Remove Turgor Volume": "Turgor Volume entfernen",
    "Remove Turgor Volume from the selected meshes, with its settings and all that it made": (
        "Turgor Volume von den gewählten Netzen entfernen, mit seinen Einstellungen und allem, was es angelegt hat"
    ),
    "Bend the active mesh along a chain of bones or a curve, every chunk of it keeping its volume": (
        "Das aktive Netz entlang einer Knochenkette oder einer Kurve biegen; jedes Stück behält sein Volumen"
    ),
    "Read the mesh again, and take the spine as it rests now: bones in rest, the curve as it is": (
        "Das Netz neu lesen und das Rückgrat nehmen, wie es jetzt ruht: Knochen in Ruhe, die Kurve, wie sie ist"
    ),
    "Remove Turgor Spine": "Turgor Spine entfernen",
    "Remove Turgor Spine from the active mesh, with its settings and all that it made": (
        "Turgor Spine vom aktiven Netz entfernen, mit seinen Einstellungen und allem, was es angelegt hat"
    ),
    # Profiles of a joint
    "Preset": "Vorlage",
    "Where and in which shape the volume comes back": "Wo und in welcher Form das Volumen zurückkommt",
    "Isotropic": "Gleichmäßig",
    "Even swelling around the joint, by the least displacement": (
        "Gleichmäßiges Schwellen um das Gelenk, mit der kleinsten Verschiebung"
    ),
    "Rubber": "Gummi",
    "Bulges sideways, along the axis of the bend": "Wölbt sich seitlich, entlang der Achse der Beugung",
    "Muscle": "Muskel",
    "Swells on the parent's side, inside the bend: a biceps": (
        "Schwillt auf der Seite des Eltern-Knochens, innen in der Beuge: ein Bizeps"
    ),
    "Folds": "Falten",
    "Wrinkles across the parent bone": "Falten quer zum Eltern-Knochen",
    "Belly": "Bauch",
    "One bulge inside the bend, folds as it closes": "Ein Wulst innen in der Beuge, Falten, wenn sie sich schließt",
    "Custom": "Eigene",
    "Profile curves of your own, starting from the preset chosen before": (
        "Eigene Profilkurven, ausgehend von der zuvor gewählten Vorlage"
    ),
    "Automatic Direction": "Automatische Richtung",
    "Let the preset choose in which direction the skin swells": (
        "Die Vorlage bestimmen lassen, in welche Richtung die Haut schwillt"
    ),
    "Direction": "Richtung",
    "Parts of the volume given back along the bone, sideways, and towards the inside of the bend": (
        "Anteile des Volumens, die entlang des Knochens, seitlich und zum Inneren der Beuge zurückgegeben werden"
    ),
    "Symmetric": "Symmetrisch",
    "One curve for both sides of the joint, drawn from its middle outwards": (
        "Eine Kurve für beide Seiten des Gelenks, von seiner Mitte nach außen gezeichnet"
    ),
    # A joint
    "Strength": "Stärke",
    "Part of the volume lost at this joint that it gives back itself": (
        "Anteil des an diesem Gelenk verlorenen Volumens, den es selbst zurückgibt"
    ),
    "Size": "Größe",
    "Length of skin that takes part, as a factor on the automatic length": (
        "Länge der beteiligten Haut, als Faktor auf die automatische Länge"
    ),
    "Mute": "Stumm",
    "Give nothing back at this joint": "An diesem Gelenk nichts zurückgeben",
    "Solo": "Solo",
    "Only joints with this switch on give volume back": "Nur Gelenke mit diesem Schalter geben Volumen zurück",
    "Select": "Auswählen",
    "Edit this joint together with the other selected ones": "Dieses Gelenk zusammen mit den anderen gewählten ändern",
    "Blend": "Mischung",
    "What leads from the first set of profile curves to the second": (
        "Was vom ersten Satz Profilkurven zum zweiten führt"
    ),
    "None": "Keine",
    "One set of profile curves": "Ein Satz Profilkurven",
    "Value": "Wert",
    "From the first set to the second by a value, which can be animated": (
        "Vom ersten Satz zum zweiten durch einen Wert, der animiert werden kann"
    ),
    "Volume Lost": "Verlorenes Volumen",
    "From the first set to the second as the joint loses volume: a bulge turns into folds": (
        "Vom ersten Satz zum zweiten, während das Gelenk Volumen verliert: Aus einem Wulst werden Falten"
    ),
    "Blend Value": "Mischwert",
    "Part of the second set of profile curves": "Anteil des zweiten Satzes Profilkurven",
    "Full at": "Voll bei",
    "Volume lost at which the second set is reached, as part of a tenth of the joint's length cubed": (
        "Verlorenes Volumen, bei dem der zweite Satz erreicht ist, als Teil von einem Zehntel der Gelenklänge hoch drei"
    ),
    # List of joints, measuring
    "Measure Volume over Frames": "Volumen über Bilder messen",
    "Find the volume that skinning takes at each joint over the scene's frames, or its preview range;"
    " rigs without animation are tried out by turning each joint": (
        "Das Volumen finden, das die Verformung an jedem Gelenk über die Bilder der Szene oder ihren Vorschaubereich"
        " nimmt; Rigs ohne Animation werden erprobt, indem jedes Gelenk gedreht wird"
    ),
    "Nothing moves in these frames: each joint was turned in turn instead": (
        "In diesen Bildern bewegt sich nichts: Stattdessen wurde jedes Gelenk einmal gedreht"
    ),
    "Joints": "Gelenke",
    "Copy to Selected": "Auf Auswahl übertragen",
    "Give the selected joints all settings and curves of the active one": (
        "Den gewählten Gelenken alle Einstellungen und Kurven des aktiven geben"
    ),
    "Mirror": "Spiegeln",
    "Give the joints on the other side of the body, by the names of their bones, all settings and curves of the"
    " active and the selected ones": (
        "Den Gelenken auf der anderen Seite des Körpers, nach den Namen ihrer Knochen, alle Einstellungen und Kurven"
        " des aktiven und der gewählten geben"
    ),
    "Select Joints": "Gelenke auswählen",
    "Choose which joints are edited together": "Bestimmen, welche Gelenke gemeinsam geändert werden",
    "Invert Selection": "Auswahl umkehren",
    "Reset": "Zurücksetzen",
    "Give the active and the selected joints the settings of a new one": (
        "Dem aktiven und den gewählten Gelenken die Einstellungen eines neuen geben"
    ),
    "Select Bone": "Knochen auswählen",
    "Enter Pose Mode and select the bone of the active joint": (
        "In den Posenmodus gehen und den Knochen des aktiven Gelenks auswählen"
    ),
    "Joint of Active Bone": "Gelenk des aktiven Knochens",
    "Show the settings of the joint at the armature's active bone": (
        "Die Einstellungen des Gelenks am aktiven Knochen der Armatur zeigen"
    ),
    "Sort by": "Sortieren nach",
    "Order of the joints": "Reihenfolge der Gelenke",
    "Volume Lost over Frames": "Über Bilder verlorenes Volumen",
    "Joints that lose most volume in the measured motion first": (
        "Gelenke zuerst, die in der gemessenen Bewegung am meisten Volumen verlieren"
    ),
    "Volume Lost Now": "Jetzt verlorenes Volumen",
    "Hierarchy": "Hierarchie",
    "By the name of the bone": "Nach dem Namen des Knochens",
    "Parents first, as the bones stand in the armature": "Eltern zuerst, wie die Knochen in der Armatur stehen",
    "Show All": "Alle zeigen",
    "Show joints that lose no volume too, at this frame or in the measured motion": (
        "Auch Gelenke zeigen, die kein Volumen verlieren, weder in diesem Bild noch in der gemessenen Bewegung"
    ),
    "{name} and {count} more": "{name} und {count} weitere",
    # The character
    "Settings": "Einstellungen",
    "Repair Folds": "Falten reparieren",
    "Where the correction alone makes the skin pass through itself, it backs off, and the volume comes"
    " back elsewhere; takes longer on every frame": (
        "Wo erst die Korrektur die Haut sich selbst durchdringen lässt, weicht sie zurück, und das Volumen kommt"
        " anderswo wieder; jedes Bild braucht länger"
    ),
    "No folds": "Keine Falten",
    "Folds: {found:,}, left: {left:,}, vertices held: {blocked:,}": (
        "Falten: {found:,}, übrig: {left:,}, gehaltene Punkte: {blocked:,}"
    ),
    "Folds that could not be repaired with the exact volume: {count:,}; lower the strength of the joint there,"
    " or pin less": (
        "Falten, die sich bei genauem Volumen nicht reparieren ließen: {count:,}; die Stärke des Gelenks dort senken"
        " oder weniger anheften"
    ),
    "Repair folds on every frame of the bake, also where Turgor Volume does not": (
        "Falten auf jedem gebackenen Bild reparieren, auch wo Turgor Volume es nicht tut"
    ),
    "Solver": "Löser",
    "How the joints share the work": "Wie die Gelenke sich die Arbeit teilen",
    "Simultaneous": "Gleichzeitig",
    "All joints at once: the order of bones never matters": (
        "Alle Gelenke auf einmal: Die Reihenfolge der Knochen ist ohne Bedeutung"
    ),
    "Sequential": "Nacheinander",
    "Joint after joint, parents first": "Gelenk für Gelenk, Eltern zuerst",
    "Flesh": "Fleisch",
    "How far skin moves as flesh does before its volume is restored: twists turn it along the bone,"
    " bends shift it to their inside. 0: as the armature leaves it": (
        "Wie weit sich die Haut wie Fleisch bewegt, ehe ihr Volumen zurückkommt: Drehungen verteilen sich am Knochen,"
        " Beugen schieben sie nach innen. 0: wie die Armatur sie lässt"
    ),
    "How far this joint follows the flesh of the character: twists turn the skin along the bone, a bend"
    " shifts it to its inside": (
        "Wie weit dieses Gelenk dem Fleisch der Figur folgt: Drehungen verteilen sich am Knochen, eine Beuge schiebt"
        " die Haut nach innen"
    ),
    "Across the limb, wide along it, to the inside of the bend: what flesh does": (
        "Quer zum Glied, weit an ihm entlang, zur Innenseite der Beuge: was Fleisch tut"
    ),
    "Bony or soft by how near the joint lies to the skin on the outside of its bends": (
        "Knochig oder weich, je nachdem, wie nah das Gelenk an der Haut der Außenseite liegt"
    ),
    "Auto": "Auto",
    "Soft": "Weich",
    "The outside of a bend: 0 where bone lies under the skin, an elbow, 1 where flesh is soft": (
        "Die Außenseite einer Beuge: 0, wo Knochen unter der Haut liegt, ein Ellbogen, 1, wo Fleisch weich ist"
    ),
    "Spread Twist": "Drehung verteilen",
    "How far a twist is spread along the whole bone, as in a forearm. 0: it stays where weights blend": (
        "Wie weit sich eine Drehung am ganzen Knochen verteilt, wie am Unterarm. 0: nur, wo Gewichte übergehen"
    ),
    "Crease": "Falte",
    "How far the inside of a bend closes on the plane that halves it instead of passing through itself": (
        "Wie weit sich die Innenseite einer Beuge an der halbierenden Ebene schließt, statt durch sich hindurchzugehen"
    ),
    "Flex": "Anspannen",
    "Bulge beyond what was lost, as a muscle that is tensed, taken from the same limb": (
        "Wölbung über das Verlorene hinaus, wie ein angespannter Muskel, dem gleichen Glied entnommen"
    ),
    "Fields": "Felder",
    "Which way the skin moves where volume comes back": "Wohin sich die Haut bewegt, wo Volumen zurückkommt",
    "Plain": "Einfach",
    "Along the gradient of the volume: small hollows and tips are pushed their own way, each its own": (
        "Entlang des Volumengradienten: kleine Mulden und Spitzen werden jede in ihre eigene Richtung geschoben"
    ),
    "Even": "Eben",
    "Along smooth normals: fine detail is carried along, and profile curves act as they are drawn": (
        "Entlang geglätteter Normalen: feine Einzelheiten werden mitgenommen, Profilkurven wirken wie gezeichnet"
    ),
    "Follow Bone Scale": "Knochenskalierung folgen",
    "Scaled or stretched bones change the volume to be kept. Off: the rest volume whatever they do": (
        "Skalierte oder gestreckte Knochen ändern das zu erhaltende Volumen. Aus: stets das Ruhevolumen"
    ),
    "Volume": "Volumen",
    "Factor on the volume to be kept; animate it for breathing": (
        "Faktor auf das zu erhaltende Volumen; zum Atmen animieren"
    ),
    "Vertex Group": "Vertex-Gruppe",
    "Where volume may come back, by the weights of a vertex group; the total stays exact": (
        "Wo Volumen zurückkommen darf, nach den Gewichten einer Vertex-Gruppe; die Summe bleibt genau"
    ),
    "Invert": "Umkehren",
    "Volume comes back outside of the group": "Volumen kommt außerhalb der Gruppe zurück",
    "Pin": "Anheften",
    "Vertices of this group stay where skinning puts them": (
        "Punkte dieser Gruppe bleiben, wohin die Armatur sie setzt"
    ),
    # Display
    "Heat Map": "Farbkarte",
    "What colors on the skin show": "Was die Farben auf der Haut zeigen",
    "No colors": "Keine Farben",
    "Displacement": "Verschiebung",
    "How far Turgor moves each vertex": "Wie weit Turgor jeden Punkt bewegt",
    "Joint Weight": "Gewicht des Gelenks",
    "How much each vertex takes part at the active joint: the product of its profiles": (
        "Wie sehr jeder Punkt am aktiven Gelenk teilnimmt: das Produkt seiner Profile"
    ),
    "Local Volume": "Lokales Volumen",
    "Change of the flesh between the skin and its bone, against rest": (
        "Änderung des Fleisches zwischen der Haut und ihrem Knochen, gegenüber der Ruhe"
    ),
    "Opacity": "Deckkraft",
    "Opacity of the heat map": "Deckkraft der Farbkarte",
    "Range": "Bereich",
    "Value with the hottest color, in units of length, or as a part of 1 for volume; 0 takes it from the frame": (
        "Wert mit der heißesten Farbe, in Längeneinheiten, bei Volumen als Teil von 1; 0 nimmt ihn aus dem Bild"
    ),
    "Joint Axes": "Gelenkachsen",
    "Draw the three directions of the active joint: along the parent, the hinge, inside the bend": (
        "Die drei Richtungen des aktiven Gelenks zeichnen: entlang des Eltern-Knochens, Scharnier, Beugeinneres"
    ),
    "Write the volume error of the frame into the viewport": "Den Volumenfehler des Bildes in die Ansicht schreiben",
    "Joint Volumes": "Volumen der Gelenke",
    "Write at each joint which volume skinning takes and Turgor gives back": (
        "An jedes Gelenk schreiben, welches Volumen die Armatur nimmt und Turgor zurückgibt"
    ),
    "Graph": "Graph",
    "Draw the volume over the measured frames, with Turgor and without": (
        "Das Volumen über die gemessenen Bilder zeichnen, mit Turgor und ohne"
    ),
    # Turgor Spine
    "Reach and Rest": "Reichweite und Ruhe",
    "Spine": "Rückgrat",
    "What the body bends along": "Woran entlang sich der Körper biegt",
    "Bones": "Knochen",
    "A chain of bones: from its rest to its pose": "Eine Knochenkette: aus ihrer Ruhe in ihre Pose",
    "Curve": "Kurve",
    "A curve object: from where it was to where it is, or onto it": (
        "Ein Kurvenobjekt: von dort, wo es war, dorthin, wo es ist, oder auf es"
    ),
    "Armature": "Armatur",
    "Armature whose bones are the spine": "Armatur, deren Knochen das Rückgrat sind",
    "From": "Von",
    "First bone of the chain, nearest to the root": "Erster Knochen der Kette, der Wurzel am nächsten",
    "To": "Bis",
    "Last bone of the chain": "Letzter Knochen der Kette",
    "Course": "Verlauf",
    "How the spine runs from joint to joint": "Wie das Rückgrat von Gelenk zu Gelenk verläuft",
    "Through Joints": "Durch die Gelenke",
    "One smooth curve through the joints: tails, tentacles, fish": (
        "Eine glatte Kurve durch die Gelenke: Schwänze, Fangarme, Fische"
    ),
    "Along Bones": "Entlang der Knochen",
    "Bones stay straight, each bend is spread around its joint: trunks, limbs": (
        "Knochen bleiben gerade, jede Beugung verteilt sich um ihr Gelenk: Rüssel, Glieder"
    ),
    "Bend Width": "Beugebreite",
    "Part of each bone that takes part in the bends at its ends": (
        "Teil jedes Knochens, der an den Beugungen an seinen Enden teilnimmt"
    ),
    "Follow Roll": "Rollen folgen",
    "Bones that roll about their length twist the body": ("Knochen, die um ihre Länge rollen, verdrehen den Körper"),
    "Curve object that is the spine; its first spline counts": (
        "Kurvenobjekt, das das Rückgrat ist; sein erster Spline zählt"
    ),
    "Rest": "Ruhe",
    "Where the body lies before it is bent": "Wo der Körper liegt, bevor er gebogen wird",
    "Curve at Rest": "Kurve in Ruhe",
    "The curve as it was when the body was bound: nothing moves until the curve does": (
        "Die Kurve, wie sie beim Binden war: Nichts bewegt sich, bis die Kurve es tut"
    ),
    "X": "X",
    "The body lies along its X axis and moves onto the curve": (
        "Der Körper liegt entlang seiner X-Achse und wandert auf die Kurve"
    ),
    "Y": "Y",
    "The body lies along its Y axis and moves onto the curve": (
        "Der Körper liegt entlang seiner Y-Achse und wandert auf die Kurve"
    ),
    "Z": "Z",
    "The body lies along its Z axis and moves onto the curve": (
        "Der Körper liegt entlang seiner Z-Achse und wandert auf die Kurve"
    ),
    "Where flesh goes that the bend displaces": "Wohin das Fleisch geht, das die Beugung verdrängt",
    "Radial": "Radial",
    "Flesh gives way evenly to all sides": "Fleisch weicht gleichmäßig nach allen Seiten aus",
    "Normal": "Normal",
    "Flesh gives way towards the inside and the outside of the bend": (
        "Fleisch weicht nach innen und außen an der Beugung aus"
    ),
    "Binormal": "Binormal",
    "Flesh gives way sideways, across the bend": "Fleisch weicht seitlich aus, quer zur Beugung",
    "Some of each": "Von jedem etwas",
    "Parts of radial, normal and binormal flesh": "Anteile radialen, normalen und binormalen Fleisches",
    "Twist Start": "Drehung am Anfang",
    "Angle about the spine at its start": "Winkel um das Rückgrat an seinem Anfang",
    "Twist End": "Drehung am Ende",
    "Angle about the spine at its end; it grows smoothly from one to the other": (
        "Winkel um das Rückgrat an seinem Ende; er wächst glatt vom einen zum anderen"
    ),
    "Slide": "Gleiten",
    "Length by which the body glides along the spine; animate it to swim along a path": (
        "Länge, um die der Körper am Rückgrat entlang gleitet; animieren, um einen Pfad entlang zu schwimmen"
    ),
    "Thin When Stretched": "Gestreckt dünner",
    "Where the spine grows longer the body grows thinner and keeps its volume": (
        "Wo das Rückgrat länger wird, wird der Körper dünner und behält sein Volumen"
    ),
    "Exact Volume": "Genaues Volumen",
    "Remove what the mesh's own coarseness leaves, evenly from the whole skin: the total is exact": (
        "Entfernen, was die Grobheit des Netzes übrig lässt, gleichmäßig von der ganzen Haut: Die Summe ist genau"
    ),
    "Start": "Anfang",
    "Part of the spine's length before which the body is carried rigidly": (
        "Teil der Länge des Rückgrats, vor dem der Körper starr getragen wird"
    ),
    "End": "Ende",
    "Part of the spine's length after which the body is carried rigidly": (
        "Teil der Länge des Rückgrats, nach dem der Körper starr getragen wird"
    ),
    "Which vertices follow the spine, and by how much": "Welche Punkte dem Rückgrat folgen, und wie sehr",
    "Vertices outside of the group follow": "Punkte außerhalb der Gruppe folgen",
    "Show Spine": "Rückgrat zeigen",
    "Draw the spine at rest and posed, its frames, the tube within which every chunk keeps its volume,"
    " and the vertices outside of it": (
        "Das Rückgrat in Ruhe und Pose zeichnen, seine Achsenkreuze, den Schlauch, in dem jedes Stück sein Volumen"
        " behält, und die Punkte außerhalb"
    ),
    # Preferences
    "Manual": "Handbuch",
    "Route": "Weg",
    "How the correction reaches the mesh": "Wie die Korrektur zum Netz gelangt",
    "Automatic": "Automatisch",
    "Pull where a self-test proves that it works, else push": (
        "Ziehen, wo ein Selbsttest zeigt, dass es geht, sonst Schieben"
    ),
    "Pull": "Ziehen",
    "Blender's dependency graph asks for the correction: one evaluation per frame": (
        "Blenders Abhängigkeitsgraph fragt nach der Korrektur: eine Auswertung je Bild"
    ),
    "Push": "Schieben",
    "Frame handlers write the correction: two evaluations per frame": (
        "Handler schreiben die Korrektur: zwei Auswertungen je Bild"
    ),
    # Drawn over the viewport
    "Before": "Vorher",
    "After": "Nachher",
    "Volume error {error}": "Volumenfehler {error}",
    "{error}, computed": "{error}, berechnet",
    "There is room for {found:,} vertices, {bound:,} were bound: press Rebind": (
        "Platz ist für {found:,} Punkte, gebunden wurden {bound:,}: Neu binden drücken"
    ),
    "without Turgor": "ohne Turgor",
    "with Turgor": "mit Turgor",
    "volume {error}": "Volumen {error}",
    "volume {error}, Turgor is off": "Volumen {error}, Turgor ist aus",
    "without Turgor {error}": "ohne Turgor {error}",
    "with Turgor {error}": "mit Turgor {error}",
    "press Measure Volume over Frames in the Turgor Volume panel": (
        "Volumen über Bilder messen drücken, im Bereich Turgor Volume"
    ),
    "Along the parent": "Entlang des übergeordneten",
    "Hinge": "Scharnier",
    "Inside of the bend": "Innen an der Beugung",
    "Viewport Display": "Ansichtsdarstellung",
    "Performance": "Leistung",
    "Text": "Text",
    "Guides": "Hilfslinien",
    "Off in the viewport": "In der Ansicht aus",
    "Read pose and settings": "Pose und Einstellungen lesen",
    "Engine": "Rechenkern",
    "Write offsets": "Versätze schreiben",
    "Add offsets to the mesh": "Versätze zum Netz addieren",
    "Armature, for comparison": "Armatur, zum Vergleich",
    "Presets that ship with Turgor stay: remove your own ones": (
        "Mit Turgor gelieferte Vorlagen bleiben: nur eigene entfernen"
    ),
    # Curves, masks, presets, diagnostics: what they do
    "Reset Curves": "Kurven zurücksetzen",
    "Go back to the preset that the shown profile curves were drawn from": (
        "Zurück zur Vorlage, nach der die gezeigten Profilkurven gezeichnet wurden"
    ),
    "Measure": "Messen",
    "Take the largest loss of the active joint over the scene's frames, or its preview range": (
        "Den größten Verlust des aktiven Gelenks über die Bilder der Szene oder ihren Vorschaubereich nehmen"
    ),
    "Save Joint as Asset": "Gelenk als Asset sichern",
    "Keep the settings and curves of the active joint as an asset of this file": (
        "Einstellungen und Kurven des aktiven Gelenks als Asset dieser Datei aufheben"
    ),
    "Apply to Turgor Joint": "Auf Turgor-Gelenk anwenden",
    "Give the active and the selected joints of the active object the settings of this asset": (
        "Dem aktiven und den gewählten Gelenken des aktiven Objekts die Einstellungen dieses Assets geben"
    ),
    "Use Joint Preset": "Gelenkvorlage benutzen",
    "Give the active and the selected joints the settings and curves of this preset": (
        "Dem aktiven und den gewählten Gelenken Einstellungen und Kurven dieser Vorlage geben"
    ),
    "Add Joint Preset": "Gelenkvorlage hinzufügen",
    "Keep the settings and curves of the active joint as a preset, or remove one": (
        "Einstellungen und Kurven des aktiven Gelenks als Vorlage aufheben, oder eine entfernen"
    ),
    "Add Turgor's Assets": "Assets von Turgor hinzufügen",
    "Show the joints that ship with Turgor in the asset browser": (
        "Die mit Turgor gelieferten Gelenke im Asset-Browser zeigen"
    ),
    "Paint Mask": "Maske malen",
    "Paint the mask in Weight Paint; the mesh follows the brush": (
        "Die Maske im Gewichtsmalen malen; das Netz folgt dem Pinsel"
    ),
    "Fix": "Beheben",
    "Mend what diagnostics found": "Beheben, was die Diagnose gefunden hat",
    "Profile Curves": "Profilkurven",
    "Joint Presets": "Gelenkvorlagen",
    "Presets": "Vorlagen",
    "Masks": "Masken",
    "Joints that lose most volume at this frame first": "Gelenke zuerst, die in diesem Bild am meisten verlieren",
    "Name": "Name",
    "Belly Folded": "Bauch, gefaltet",
    "What Belly turns into: folds inside the bend": "Was aus Bauch wird: Falten innen in der Beuge",
    "Parts of the volume given back along the bone, across, and towards the inside of the bend."
    " Moving one scales the others, so that the sum stays one": (
        "Anteile des Volumens, die entlang des Knochens, quer und zum Inneren der Beuge zurückgegeben werden."
        " Wird einer verschoben, so folgen die anderen, damit die Summe eins bleibt"
    ),
    "Set": "Satz",
    "Which set of profile curves is shown": "Welcher Satz Profilkurven gezeigt wird",
    "First": "Erster",
    "Show the first set of profile curves": "Den ersten Satz Profilkurven zeigen",
    "Second": "Zweiter",
    "Show the second set of profile curves": "Den zweiten Satz Profilkurven zeigen",
    "Along the Bone": "Entlang des Knochens",
    "Across, Seen from Inside": "Quer, von innen gesehen",
    "Into the Bend": "In die Beuge",
    "Along": "Entlang",
    "Across": "Quer",
    "Inside": "Innen",
    "Outside": "Außen",
    "Parent": "Übergeordneter",
    "Child": "Untergeordneter",
    "Left": "Links",
    "Right": "Rechts",
    "Joint": "Gelenk",
    "Parent, Child": "Übergeordneter, Untergeordneter",
    "Left, Right": "Links, Rechts",
    "Outside, Inside": "Außen, Innen",
    "Muted: it gives nothing back": "Stumm: gibt nichts zurück",
    "Another joint is solo: it gives nothing back": "Ein anderes Gelenk ist solo: dieses gibt nichts zurück",
    "Skinning": "Armatur",
    "Turgor": "Turgor",
    "Remove": "Entfernen",
    "Add Turgor Volume": "Turgor Volume hinzufügen",
    "Diagnostics": "Diagnose",
    "Nothing is off": "Nichts zu beanstanden",
    "Turgor cannot run here; meshes show plain skinning.": (
        "Turgor läuft hier nicht; Netze zeigen sich, wie die Armatur sie macht."
    ),
    "of the fleshing alone {error}": "vom Biegen allein {error}",
    "of small chunks {mean:.4f} %, at most {most:.3f} %": "kleiner Stücke {mean:.4f} %, höchstens {most:.3f} %",
    "{time:.2f} ms per frame": "{time:.2f} ms je Bild",
    # What stands in the way of an operator
    "Leave the edit or paint mode first": "Zuerst den Bearbeitungs- oder Malmodus verlassen",
    "Select a mesh that an armature deforms": "Ein Netz auswählen, das eine Armatur verformt",
    "Select a mesh": "Ein Netz auswählen",
    "The object is linked: make a library override first": (
        "Das Objekt ist verknüpft: zuerst eine Bibliotheksüberschreibung anlegen"
    ),
    "The object has Turgor Volume already": "Das Objekt hat schon Turgor Volume",
    "The object has Turgor Spine already": "Das Objekt hat schon Turgor Spine",
    "The active object has no Turgor Volume of its own": "Das aktive Objekt hat kein eigenes Turgor Volume",
    "The active object has no Turgor Volume": "Das aktive Objekt hat kein Turgor Volume",
    "The active object has no Turgor Spine of its own": "Das aktive Objekt hat kein eigenes Turgor Spine",
    "The active object has no joints of Turgor Volume": "Das aktive Objekt hat keine Gelenke von Turgor Volume",
    "The active object has no joints of Turgor Volume of its own": (
        "Das aktive Objekt hat keine eigenen Gelenke von Turgor Volume"
    ),
    "The active object has no Turgor": "Das aktive Objekt hat kein Turgor",
    "Make a mesh with Turgor active": "Ein Netz mit Turgor aktiv machen",
    "No selected mesh has Turgor Volume": "Kein gewähltes Netz hat Turgor Volume",
    "The shown profile curves are those of a preset": "Die gezeigten Profilkurven sind die einer Vorlage",
    "The joint loses no volume in these frames": "Das Gelenk verliert in diesen Bildern kein Volumen",
    "This build of Turgor ships no assets": "Mit dieser Fassung von Turgor kommen keine Assets",
    "They are shown already": "Sie werden schon gezeigt",
    "{asset} is no joint of Turgor: choose one tagged Turgor": (
        "{asset} ist kein Gelenk von Turgor: eines mit dem Schlagwort Turgor wählen"
    ),
    "No other joint is selected: tick some in the list": "Kein anderes Gelenk ist gewählt: in der Liste anhaken",
    "The character has no armature, or no joint is active": "Die Figur hat keine Armatur, oder kein Gelenk ist aktiv",
    "The names of these joints have no side, like Arm.L or left_arm": (
        "Die Namen dieser Gelenke haben keine Seite wie Arm.L oder left_arm"
    ),
    "No joint on the other side of {joints}": "Kein Gelenk auf der anderen Seite von {joints}",
    "The active bone has no joint": "Der aktive Knochen hat kein Gelenk",
    "The armature has no active bone": "Die Armatur hat keinen aktiven Knochen",
    "The mesh is linked: paint it in its own file": "Das Netz ist verknüpft: in seiner eigenen Datei malen",
    "The mesh is linked: change it in its own file": "Das Netz ist verknüpft: in seiner eigenen Datei ändern",
    "The armature is linked: change it in its own file": "Die Armatur ist verknüpft: in ihrer eigenen Datei ändern",
    "The modifier comes from the library: move it there": "Der Modifikator kommt aus der Bibliothek: dort verschieben",
    "There is no joint {joint} any more": "Es gibt kein Gelenk {joint} mehr",
    "There is no modifier {modifier} any more": "Es gibt keinen Modifikator {modifier} mehr",
    "The preset's {name} cannot be {found}": "{name} der Vorlage kann nicht {found} sein",
    "The preset is of format {found}, this Turgor reads {known}": (
        "Die Vorlage hat das Format {found}, dieses Turgor liest {known}"
    ),
    "{found} characters, need at most {most}": "{found} Zeichen, höchstens {most} sind möglich",
    "line {line} has {found}": "in Zeile {line} steht {found}",
    "brackets are more than {most} deep": "Klammern sind mehr als {most} tief",
    "a number has more than {most} characters": "eine Zahl hat mehr als {most} Zeichen",
    "Not a joint preset of Turgor: {error}": "Keine Gelenkvorlage von Turgor: {error}",
    "Not a joint preset of Turgor: it has no turgor_joint": "Keine Gelenkvorlage von Turgor: turgor_joint fehlt",
    # What is off
    "plain skinning": "was die Armatur allein macht",
    "the body without its spine": "den Körper ohne sein Rückgrat",
    "No vertex group is named after a deform bone of {rig}: assign weights": (
        "Keine Vertex-Gruppe heißt wie ein verformender Knochen von {rig}: Gewichte zuweisen"
    ),
    "too open to hold a volume": "zu offen für ein Volumen",
    "flat, holds no volume": "flach, ohne Volumen",
    "edges with three or more faces": "Kanten mit drei oder mehr Flächen",
    "faces that cannot agree which side is out": "Flächen, die sich nicht einigen, wo außen ist",
    "Vertices that no bone holds and that stay behind: {count:,}; give them weights": (
        "Punkte, die kein Knochen hält und die zurückbleiben: {count:,}; ihnen Gewichte geben"
    ),
    "{count:,} of {all:,} vertices lie too far inside a bend and are held back there": (
        "{count:,} von {all:,} Punkten liegen zu weit innen in einer Beuge und werden dort gehalten"
    ),
    "Parts not corrected: {count}, {reason}": "Nicht korrigierte Teile: {count}, {reason}",
    "Parts that are inside out: {count}; recalculate their normals": (
        "Umgestülpte Teile: {count}; ihre Normalen neu berechnen"
    ),
    "Parts whose faces look both ways: {count}; recalculate their normals": (
        "Teile, deren Flächen in beide Richtungen sehen: {count}; ihre Normalen neu berechnen"
    ),
    "Open parts that count as if they were closed: {count}, with {edges:,} edges around their openings": (
        "Offene Teile, die wie geschlossene zählen: {count}, mit {edges:,} Kanten um ihre Öffnungen"
    ),
    "Evaluates each frame twice: {reason}": "Wertet jedes Bild zweimal aus: {reason}",
    "The strength of joints leaves {percent:+.2f} % of the volume: {joints}": (
        "Die Stärke von Gelenken lässt {percent:+.2f} % des Volumens: {joints}"
    ),
    "Strength of {modifier} is {part:.2f}: the mesh lies between plain skinning and the exact volume": (
        "Die Stärke von {modifier} ist {part:.2f}: Das Netz liegt zwischen Armatur allein und genauem Volumen"
    ),
    "{joint} has no room for all of its volume; the rest went to the skin around: give it a larger Size": (
        "{joint} hat nicht Platz für all sein Volumen; der Rest ging in die Haut ringsum: mehr Größe geben"
    ),
    "{count} joints have no room for all of their volume: {joints}; the rest went to the skin around: give them"
    " a larger Size": (
        "{count} Gelenke haben nicht Platz für all ihr Volumen: {joints}; der Rest ging in die Haut ringsum: mehr Größe"
        " geben"
    ),
    "The mesh has another volume than was computed: measured {measured}, computed {computed}; something else moves"
    " its vertices, or the node group of {modifier} was edited": (
        "Das Netz hat ein anderes Volumen als berechnet: gemessen {measured}, berechnet {computed}; etwas anderes"
        " bewegt seine Punkte, oder die Nodegruppe von {modifier} wurde geändert"
    ),
    "{modifier} changes the volume after Turgor Volume, by {percent}: move Turgor Volume below it": (
        "{modifier} ändert das Volumen nach Turgor Volume, um {percent}: Turgor Volume darunter verschieben"
    ),
    "{modifier} changes the volume after Turgor Volume, by {percent} beyond what it does at rest: move"
    " Turgor Volume below it": (
        "{modifier} ändert das Volumen nach Turgor Volume, um {percent} über das hinaus, was er in Ruhe tut: Turgor"
        " Volume darunter verschieben"
    ),
    "{count} Armature modifiers deform the body before Turgor Spine: {names}; move them below, or flesh their"
    " own bones": (
        "{count} Armatur-Modifikatoren verformen den Körper vor Turgor Spine: {names}; sie darunter verschieben oder"
        " ihre eigenen Knochen nehmen"
    ),
    "{count} Armature modifiers deform again after Turgor Volume: {names}; move Turgor Volume below them": (
        "{count} Armatur-Modifikatoren verformen nach Turgor Volume nochmals: {names}; Turgor Volume darunter schieben"
    ),
    "{count} modifiers can change the mesh from frame to frame before ours: {names}; move them after Turgor": (
        "{count} Modifikatoren können das Netz vor unserem von Bild zu Bild ändern: {names}; sie hinter Turgor schieben"
    ),
    "{count} modifiers simulate before Turgor Volume: {names}; move them after it": (
        "{count} Modifikatoren simulieren vor Turgor Volume: {names}; sie dahinter schieben"
    ),
    "{count} modifiers before ours change shape keys: {names}; apply them, or move them after Turgor": (
        "{count} Modifikatoren vor unserem ändern Formschlüssel: {names}; sie anwenden oder hinter Turgor verschieben"
    ),
    "{count} modifiers are on in the viewport or in renders only: {names}; renders show the mesh without Turgor": (
        "{count} Modifikatoren sind nur in der Ansicht oder nur in Renderings an: {names}; Renderings zeigen das Netz"
        " ohne Turgor"
    ),
    "{count} modifiers have other levels in renders than in the viewport: {names}; make them equal, or renders"
    " show the mesh without Turgor": (
        "{count} Modifikatoren haben in Renderings andere Stufen als in der Ansicht: {names}; sie angleichen, sonst"
        " zeigen Renderings das Netz ohne Turgor"
    ),
    "Blender lets {ours} stand only below {modifier}, which needs the mesh as it is stored: move {modifier}"
    " above the Armature, or apply it": (
        "Blender lässt {ours} nur unter {modifier} stehen, der das gespeicherte Netz braucht: {modifier} über die"
        " Armatur verschieben oder anwenden"
    ),
    "Blender lets {ours} stand only below {modifier}, which needs the mesh as it is stored: remove"
    " {modifier}, or simulate a copy of the mesh": (
        "Blender lässt {ours} nur unter {modifier} stehen, der das gespeicherte Netz braucht: {modifier} entfernen oder"
        " eine Kopie des Netzes simulieren"
    ),
    "Blender does not let {modifier} stand there: {reason}": "Blender lässt {modifier} dort nicht stehen: {reason}",
    "Blender does not let {modifier} stand there: move it by hand": (
        "Blender lässt {modifier} dort nicht stehen: von Hand verschieben"
    ),
    "Turgor Volume cannot stand below {modifier}: {problem}": (
        "Turgor Volume kann nicht unter {modifier} stehen: {problem}"
    ),
    "There is no Turgor Volume any more": "Es gibt kein Turgor Volume mehr",
    "Move Turgor below It": "Turgor darunter",
    "Move Turgor Volume below this modifier, where it keeps the volume again": (
        "Turgor Volume unter diesen Modifikator verschieben, wo es das Volumen wieder erhält"
    ),
    "The object is hidden: show it first": "Das Objekt ist verborgen: zuerst zeigen",
    "{file} is a folder: choose another name": "{file} ist ein Ordner: einen anderen Namen wählen",
    "{file} was not written: look at the console for the reason": (
        "{file} wurde nicht geschrieben: Der Grund steht in der Konsole"
    ),
    "with Turgor, computed": "mit Turgor, berechnet",
    "There is no vertex group {group} any more: choose another, or clear the mask": (
        "Es gibt keine Vertex-Gruppe {group} mehr: eine andere wählen oder die Maske leeren"
    ),
    "Parts that masks pin as a whole, which stay as skinned: {count}": (
        "Teile, die Masken ganz anheften und die bleiben, wie die Armatur sie macht: {count}"
    ),
    "{modifier} is off in renders": "{modifier} ist in Renderings aus",
    "{modifier} is off in the viewport": "{modifier} ist in der Ansicht aus",
    "Mesh changed: its vertices or faces are others than when it was bound; press Rebind": (
        "Das Netz ist anders: seine Punkte oder Flächen sind andere als beim Binden; Neu binden drücken"
    ),
    "The mesh has no vertices before the Armature modifier: give it some": (
        "Das Netz hat keine Punkte vor dem Armatur-Modifikator: ihm welche geben"
    ),
    "The character is linked with its offsets, which push cannot write: choose pull in the preferences": (
        "Die Figur ist mit ihren Versätzen verknüpft, die Schieben nicht schreiben kann: in den Einstellungen"
        " Ziehen wählen"
    ),
    "Bones were removed from the armature: leave its edit mode, or press Rebind": (
        "Der Armatur wurden Knochen entfernt: ihren Bearbeitungsmodus verlassen, oder Neu binden drücken"
    ),
    "No Armature modifier: Turgor Spine alone keeps the volume by itself, turn on its Exact Volume": (
        "Kein Armatur-Modifikator: Turgor Spine allein erhält das Volumen selbst, sein Genaues Volumen einschalten"
    ),
    "Shape keys are absolute: make them Relative in the mesh's properties": (
        "Formschlüssel sind absolut: in den Eigenschaften des Netzes auf Relativ stellen"
    ),
    "{modifier} uses Multi Modifier, which blends two armatures: turn it off": (
        "{modifier} benutzt Multi-Modifikator und mischt zwei Armaturen: ausschalten"
    ),
    "{modifier} is on in the viewport or in renders only: renders show {shown}": (
        "{modifier} ist nur in der Ansicht oder nur in Renderings an: Renderings zeigen {shown}"
    ),
    "{modifier} is on in the viewport or in renders only: renders show plain skinning": (
        "{modifier} ist nur in der Ansicht oder nur in Renderings an: Renderings zeigen, was die Armatur allein macht"
    ),
    "{modifier} has other levels in renders ({in_render}) than in the viewport ({in_viewport}):"
    " make them equal, or renders show {shown}": (
        "{modifier} hat in Renderings andere Stufen ({in_render}) als in der Ansicht ({in_viewport}):"
        " angleichen, sonst zeigen Renderings {shown}"
    ),
    "Modifier {modifier} has no armature object: choose one": "Modifikator {modifier} hat keine Armatur: eine wählen",
    "{modifier} has animated settings: remove their keyframes and drivers": (
        "{modifier} hat animierte Einstellungen: ihre Keyframes und Treiber entfernen"
    ),
    "{modifier} asks whether it is in the viewport: renders show {shown}": (
        "{modifier} fragt, ob es in der Ansicht ist: Renderings zeigen {shown}"
    ),
    "{modifier} deforms neither by vertex groups nor by bones with envelopes: turn on Vertex Groups": (
        "{modifier} verformt weder durch Vertex-Gruppen noch durch Knochen mit Hüllen: Vertex-Gruppen einschalten"
    ),
    "{rig} moves this mesh by {count:,} bones and segments, {most:,} are possible: lower segments of bones": (
        "{rig} bewegt dieses Netz mit {count:,} Knochen und Segmenten, höchstens {most:,} gehen:"
        " Segmente von Biegeknochen verringern"
    ),
    "{what} moves skin along bendy bones or through envelopes": (
        "{what} verschiebt Haut entlang von Biegeknochen oder durch Hüllen"
    ),
    "{what} moves skin along bendy bones or through envelopes, whose weights then change from frame to frame: let it"
    " move other skin only, or set the bones' segments to 1": (
        "{what} verschiebt Haut entlang von Biegeknochen oder durch Hüllen, deren Gewichte sich dann von Bild zu Bild"
        " ändern: nur andere Haut verschieben lassen, oder die Segmente der Knochen auf 1 setzen"
    ),
    "Segments of {rig} are scaled to nothing at rest: give its bendy bones another scale": (
        "Segmente von {rig} sind in Ruhe auf nichts skaliert: seinen Biegeknochen eine andere Skalierung geben"
    ),
    "Shape key {key}": "Formschlüssel {key}",
    "Bone {bone}, whose curve at rest is animated,": "Knochen {bone}, dessen Kurve in Ruhe animiert ist,",
    "bend of {bone}": "Biegung von {bone}",
    "Segments of bendy bones are others than were bound: press Rebind": (
        "Segmente von Biegeknochen sind andere als die gebundenen: Neu binden drücken"
    ),
    "Bone {bone} has an animated curve at rest, by whose axes Preserve Volume splits off scale": (
        "Knochen {bone} hat eine animierte Kurve in Ruhe, nach deren Achsen Volumen erhalten die Skalierung abspaltet"
    ),
    "{object} may stand elsewhere to its bendy bones or envelopes than when bound": (
        "{object} kann anders zu seinen Biegeknochen oder Hüllen stehen als beim Binden"
    ),
    "Bendy bones of this character lie by how others are posed: pose-driven keys cannot follow, bake its frames": (
        "Biegeknochen dieser Figur liegen so, wie andere Knochen stehen: Von Posen getriebene Schlüssel können ihnen"
        " nicht folgen, Bilder backen"
    ),
    "{modifier} deforms the body before Turgor Spine: move it below, or flesh its own bones": (
        "{modifier} verformt den Körper vor Turgor Spine: darunter verschieben oder dessen eigene Knochen nehmen"
    ),
    "{modifier} can move the body before Turgor Spine: move it below": (
        "{modifier} kann den Körper vor Turgor Spine bewegen: darunter verschieben"
    ),
    "{modifier} is animated before Turgor Spine: move it below": (
        "{modifier} ist vor Turgor Spine animiert: darunter verschieben"
    ),
    "{modifier} changes shape keys before Turgor Spine: apply it, or move it below": (
        "{modifier} ändert Formschlüssel vor Turgor Spine: anwenden oder darunter verschieben"
    ),
    # Buttons that mend
    "Read the mesh, its weights and its armature again; settings stay": (
        "Netz, Gewichte und Armatur neu lesen; Einstellungen bleiben"
    ),
    "Move below Armature": "Unter die Armatur",
    "Move below Turgor": "Unter Turgor",
    "Move this modifier below, where it changes what Turgor made": (
        "Diesen Modifikator darunter verschieben, wo er ändert, was Turgor gemacht hat"
    ),
    "Show in Viewport": "In der Ansicht zeigen",
    "Turn the modifier on in the viewport": "Den Modifikator in der Ansicht einschalten",
    "Show in Renders": "In Renderings zeigen",
    "Turn the modifier on in renders": "Den Modifikator in Renderings einschalten",
    "Turn Off Multi Modifier": "Multi-Modifikator ausschalten",
    "Let this Armature modifier deform alone": "Diesen Armatur-Modifikator allein verformen lassen",
    "Use Viewport Setting in Renders": "Wie in der Ansicht rendern",
    "Let renders use this modifier as the viewport does": (
        "Renderings diesen Modifikator benutzen lassen wie die Ansicht"
    ),
    "Select Open Edges": "Offene Kanten auswählen",
    "Go to Edit Mode with the edges around openings selected": (
        "In den Bearbeitungsmodus, die Kanten um Öffnungen gewählt"
    ),
    "Select Edges": "Kanten auswählen",
    "Go to Edit Mode with the edges of three or more faces selected": (
        "In den Bearbeitungsmodus, die Kanten mit drei oder mehr Flächen gewählt"
    ),
    "Select Vertices": "Punkte auswählen",
    "Go to Edit Mode with the vertices selected that no bone holds": (
        "In den Bearbeitungsmodus, die Punkte gewählt, die kein Knochen hält"
    ),
    "Recalculate Outside": "Außenseite neu berechnen",
    "Turn faces that look inwards, in parts that hold a volume": (
        "Flächen umdrehen, die nach innen sehen, in Teilen mit Volumen"
    ),
    "Larger Size": "Mehr Größe",
    "Let half as much skin again take part at this joint": "An diesem Gelenk halb so viel Haut mehr beteiligen",
    "Clear Group": "Gruppe leeren",
    "Use no vertex group here": "Hier keine Vertex-Gruppe benutzen",
    # Baking
    "Bake": "Backen",
    "Make a copy that shows the same without Turgor, by shape keys or a point cache, as chosen below;"
    " Esc cancels, and the next bake goes on from there": (
        "Eine Kopie anlegen, die ohne Turgor dasselbe zeigt, durch Formschlüssel oder einen Punkte-Cache, wie unten"
        " gewählt; Esc bricht ab, und das nächste Backen fährt dort fort"
    ),
    "Remove Bake": "Gebackenes entfernen",
    "Delete the baked copy and show the live mesh again; files of caches and reports stay": (
        "Die gebackene Kopie löschen und das lebende Netz wieder zeigen; Dateien von Caches und Berichten bleiben"
    ),
    "Turgor Bake": "Turgor Backen",
    "Method": "Verfahren",
    "In": "In",
    "The active object has neither Turgor Volume nor Turgor Spine": (
        "Das aktive Objekt hat weder Turgor Volume noch Turgor Spine"
    ),
    "A bake is running": "Es wird gerade gebacken",
    "Bake cancelled; what was computed is kept for the next one": (
        "Backen abgebrochen; was berechnet wurde, bleibt für das nächste Mal"
    ),
    "The active object has no bake": "Das aktive Objekt hat nichts Gebackenes",
    "Baked {what}": "Gebacken: {what}",
    "What keeps the result": "Was das Ergebnis hält",
    "Shape Keys": "Formschlüssel",
    "One shape key per frame on a copy without armature": "Ein Formschlüssel je Bild an einer Kopie ohne Armatur",
    "Corrective Keys": "Korrekturschlüssel",
    "One shape key per frame before the Armature, which still moves the copy": (
        "Ein Formschlüssel je Bild vor der Armatur, die die Kopie weiter bewegt"
    ),
    "Reduced Correctives": "Wenige Korrekturschlüssel",
    "As few keyed correctives before the Armature as keep the error asked for": (
        "So wenige Korrekturschlüssel vor der Armatur, wie den verlangten Fehler halten"
    ),
    "Pose Correctives": "Korrekturen aus der Pose",
    "Correctives that the pose drives: new animation needs no new bake": (
        "Korrekturen, die die Pose treibt: neue Animation braucht kein neues Backen"
    ),
    "Point Cache": "Punkte-Cache",
    "A PC2 file with the points of every frame, read by a Mesh Cache modifier": (
        "Eine PC2-Datei mit den Punkten jedes Bildes, gelesen vom Modifikator Mesh Cache"
    ),
    "Frames": "Bilder",
    "Frames to bake, such as 1-100, 1-100x2 for every second one, or 1-100x0.25 for steps within frames."
    " Empty: the scene's range": (
        "Zu backende Bilder wie 1-100, 1-100x2 für jedes zweite oder 1-100x0.25 für Schritte dazwischen."
        " Leer: der Bereich der Szene"
    ),
    "Error In": "Fehler in",
    "What the error is measured in": "Worin der Fehler gemessen wird",
    "Percent": "Prozent",
    "Part of the size of the mesh, the diagonal of its bounds": (
        "Teil der Größe des Netzes, der Diagonale seiner Grenzen"
    ),
    "Length": "Länge",
    "Length in the scene": "Länge in der Szene",
    "Largest Error": "Größter Fehler",
    "How far any vertex may be from the live mesh on any frame": (
        "Wie weit ein Punkt in irgendeinem Bild vom lebenden Netz entfernt sein darf"
    ),
    "Values 0 to 1": "Werte 0 bis 1",
    "No negative values, for engines that clamp them: one more key, which is always on, or keys for both directions"
    " where they are local to joints": (
        "Keine negativen Werte, für Engines, die sie abschneiden: ein Schlüssel mehr, der immer an ist, oder, wo sie zu"
        " je einem Gelenk gehören, Schlüssel für beide Richtungen"
    ),
    "A driver of {owner} reads {path} of the scene by its name, which cannot be baked or measured: make its variable a"
    " Context Property of the Active Scene": (
        "Ein Treiber von {owner} liest {path} der Szene unter ihrem Namen, was sich weder backen noch messen lässt:"
        " seine Variable zu einer Kontexteigenschaft der aktiven Szene machen"
    ),
    "Import the file again, in a Blender of its own, and compare shape and volume with the live mesh": (
        "Die Datei in einem eigenen Blender wieder importieren und Form und Volumen mit dem lebenden Netz vergleichen"
    ),
    "{name}: imported again, largest error {error:.2g} % of the size, volume within {volume:.2g} %": (
        "{name}: wieder importiert, größter Fehler {error:.2g} % der Größe, Volumen bis auf {volume:.2g} %"
    ),
    "{file} was not compared: Blender ended early": "{file} wurde nicht verglichen: Blender endete vorzeitig",
    "The file was not compared: {reason}": "Die Datei wurde nicht verglichen: {reason}",
    "Local to Joints": "Je Gelenk",
    "Every key moves the skin around one joint only and is named after its bone, so that it can be sculpted on; takes"
    " more keys": (
        "Jeder Schlüssel bewegt nur die Haut um ein Gelenk und heißt nach dessen Knochen, sodass man ihn"
        " nachmodellieren kann; braucht mehr Schlüssel"
    ),
    "Most Keys": "Höchstens Schlüssel",
    "Pose correctives to have at most": "So viele Korrekturen aus der Pose höchstens",
    "Bones per Vertex": "Knochen je Punkt",
    "Largest weights of each vertex that the target keeps, 0 for all; game engines keep 4": (
        "Größte Gewichte jedes Punktes, die das Ziel behält, 0 für alle; Spiel-Engines behalten 4"
    ),
    "Linear Skinning": "Lineares Skinning",
    "The target blends bones linearly, as game engines do, also where the Armature preserves volume": (
        "Das Ziel mischt Knochen linear wie Spiel-Engines, auch wo die Armatur Volumen erhält"
    ),
    "Folder": "Ordner",
    "Where point caches, reports and unfinished bakes are kept": (
        "Wo Punkte-Caches, Berichte und Unfertiges aufbewahrt werden"
    ),
    "Verify": "Prüfen",
    "Play the bake in Blender and compare it with the live character, and on every frame with what was computed": (
        "Das Gebackene in Blender abspielen und mit der lebenden Figur vergleichen, auf jedem Bild mit dem Berechneten"
    ),
    "On Every Frame": "Auf jedem Bild",
    "Compare every frame with the live character. Off: the first and the last, those at which joints are worst, and"
    " some between": (
        "Jedes Bild mit der lebenden Figur vergleichen. Aus: das erste und das letzte, die mit dem größten Verlust der"
        " Gelenke und einige dazwischen"
    ),
    "On frame {frame} modifiers after Turgor make {live} vertices live and {baked} of the copy: compared without"
    " them": (
        "Auf Bild {frame} machen Modifikatoren nach Turgor {live} Punkte der lebenden Figur und {baked} der Kopie:"
        " ohne sie verglichen"
    ),
    "On frame {frame} the live character has {live} vertices and its copy {baked}: they cannot be compared": (
        "Auf Bild {frame} hat die lebende Figur {live} Punkte und ihre Kopie {baked}: nicht vergleichbar"
    ),
    "{file} was of a bake of frames {frames} with other settings, and was replaced": (
        "{file} war von einem Backen der Bilder {frames} mit anderen Einstellungen und wurde ersetzt"
    ),
    "Hide Original": "Original verbergen",
    "Hide the live mesh in the viewport and in renders when its bake is there": (
        "Das lebende Netz in Ansicht und Renderings verbergen, wenn das Gebackene da ist"
    ),
    # Export
    "Export with Volume": "Mit Volumen exportieren",
    "Write the selected characters over the scene's frames by Blender's own exporter, so that they keep their volume"
    " where there is no Turgor": (
        "Die gewählten Figuren über die Bilder der Szene mit Blenders eigenem Exporter schreiben, so dass sie ihr"
        " Volumen auch ohne Turgor behalten"
    ),
    "Format": "Format",
    "What is written": "Was geschrieben wird",
    "glTF 2.0": "glTF 2.0",
    "FBX": "FBX",
    "USD": "USD",
    "Alembic": "Alembic",
    "Armature and shape keys, for engines and the web": "Armatur und Shape-Keys, für Engines und das Netz",
    "Armature and shape keys, for engines and other programs": (
        "Armatur und Shape-Keys, für Engines und andere Programme"
    ),
    "Every frame of the mesh, without armature": "Jedes Bild des Netzes, ohne Armatur",
    "How far any vertex may be from the live mesh on any frame, in percent of its size; as few shape keys as keep it, 0"
    " for one key per frame": (
        "Wie weit ein Punkt in einem Bild vom lebenden Netz entfernt sein darf, in Prozent der Größe; so wenige"
        " Shape-Keys, wie das einhalten, 0 für einen je Bild"
    ),
    "Formats that keep the exact volume where there is no Turgor": (
        "Formate, die das genaue Volumen auch ohne Turgor behalten"
    ),
    "Select a mesh with Turgor Volume or Turgor Spine": "Ein Netz mit Turgor Volume oder Turgor Spine wählen",
    "{modifier} is not in the file: with it shape keys would be lost": (
        "{modifier} ist nicht in der Datei: mit ihm gingen Shape-Keys verloren"
    ),
    "No selected object has Turgor Volume or Turgor Spine: select a character": (
        "Kein gewähltes Objekt hat Turgor Volume oder Turgor Spine: eine Figur wählen"
    ),
    "{file} was not written: {reason}": "{file} wurde nicht geschrieben: {reason}",
    # Automatic weights
    "With Turgor Weights": "Mit Turgor-Gewichten",
    "Parent the selected meshes to the active armature, with weights by distances inside of the body;"
    " open, broken and several meshes get weights too": (
        "Die gewählten Netze der aktiven Armatur unterordnen, mit Gewichten nach Abständen im Innern des Körpers;"
        " auch offene, kaputte und mehrere Netze bekommen Gewichte"
    ),
    "Turgor Weights from Bones": "Turgor-Gewichte von Knochen",
    "Give the selected bones weights by distances inside of the body, on the selected vertices"
    " if Vertex Selection is on": (
        "Den gewählten Knochen Gewichte nach Abständen im Innern des Körpers geben, auf den gewählten Punkten, wenn die"
        " Punktauswahl an ist"
    ),
    "Resolution": "Auflösung",
    "Voxels along the longest side of the body, 0 for as many as it needs; parts two voxels apart are apart": (
        "Voxel entlang der längsten Seite des Körpers, 0 für so viele, wie er braucht; Teile im Abstand von zwei Voxeln"
        " sind getrennt"
    ),
    "Falloff": "Abnahme",
    "How fast a bone's hold falls with distance": "Wie schnell der Halt eines Knochens mit dem Abstand abnimmt",
    "Smoothing": "Glättung",
    "Length over which weights pass from bone to bone, in distances to the nearest bone": (
        "Länge, über die Gewichte von Knochen zu Knochen übergehen, in Abständen zum nächsten Knochen"
    ),
    "Max Influences": "Höchstzahl der Einflüsse",
    "Bones that may hold a vertex; 0 for any number": "Knochen, die einen Punkt halten dürfen; 0 für beliebig viele",
    "Symmetry": "Symmetrie",
    "Vertices that mirror each other across the armature's X axis get mirrored weights": (
        "Punkte, die an der X-Achse der Armatur gespiegelt liegen, bekommen gespiegelte Gewichte"
    ),
    "Keep Locked": "Gesperrte behalten",
    "Turgor Stiffness": "Turgor-Steifheit",
    "How strongly the bone holds the skin when Turgor weights are made: at 2 as if it were at half its distance, at 0.5"
    " as if at twice": (
        "Wie stark der Knochen die Haut hält, wenn Turgor-Gewichte entstehen: bei 2, als wäre er halb so weit entfernt,"
        " bei 0,5, als wäre er doppelt so weit entfernt"
    ),
    "Locked vertex groups keep their weights, the others share what is left": (
        "Gesperrte Gruppen behalten ihre Gewichte, die anderen teilen sich den Rest"
    ),
    "Cancelled, weights are as they were": "Abgebrochen, die Gewichte sind wie vorher",
    "Turgor Weights: {percent} %  |  Esc: Cancel": "Turgor-Gewichte: {percent} %  |  Esc: Abbrechen",
    "{count} vertices lie in parts that no bone reaches: they follow the nearest part": (
        "{count} Punkte liegen in Teilen, die kein Knochen erreicht: Sie folgen dem nächsten Teil"
    ),
    "Select meshes, then the armature": "Netze wählen, dann die Armatur",
    "Go to Weight Paint on a mesh first": "Zuerst bei einem Netz in die Gewichtsmalerei gehen",
    "The mesh has no Armature modifier with an armature": "Das Netz hat keinen Armatur-Modifikator mit einer Armatur",
    "{armature} has no deform bone: turn Deform on for its bones": (
        "{armature} hat keinen verformenden Knochen: bei seinen Knochen Verformen einschalten"
    ),
    "All chosen bones are locked: unlock a vertex group, or turn Keep Locked off": (
        "Alle gewählten Knochen sind gesperrt: eine Gruppe entsperren oder Gesperrte behalten ausschalten"
    ),
    "The mesh of {object} is linked: make it local first": "Das Netz von {object} ist verknüpft: zuerst lokal machen",
    # Refine
    "Refine": "Verfeinern",
    "Split faces where joints give back volume over the scene's frames, or its preview range; all that the mesh carries"
    " goes along": (
        "Flächen teilen, wo Gelenke in den Bildern der Szene oder ihrem Vorschaubereich Volumen zurückgeben; alles, was"
        " das Netz trägt, geht mit"
    ),
    "Threshold": "Schwelle",
    "Least weight of a joint that loses volume, from which on faces are refined": (
        "Kleinstes Gewicht eines Gelenks, das Volumen verliert, ab dem Flächen verfeinert werden"
    ),
    "Levels": "Stufen",
    "Most Levels": "Höchstens Stufen",
    "How often faces are split into four; the most where automatic": (
        "Wie oft Flächen in vier geteilt werden; bei Automatisch höchstens so oft"
    ),
    "Split each face only as often as the profile curves of its joints need to be seen: folds more than bulges": (
        "Jede Fläche nur so oft teilen, dass die Profilkurven ihrer Gelenke zu sehen sind: Falten öfter als Wülste"
    ),
    "Where new vertices lie": "Wo neue Punkte liegen",
    "Linear": "Linear",
    "New vertices lie on the surface as it is: the rest shape stays the same": (
        "Neue Punkte liegen auf der Oberfläche, wie sie ist: Die Ruheform bleibt gleich"
    ),
    "Smooth": "Glatt",
    "New vertices lie on a smooth surface through those that are there; where a Subdivision Surface modifier makes"
    " that surface, it stays": (
        "Neue Punkte liegen auf einer glatten Fläche durch die vorhandenen; wo der Modifikator Unterteilungsfläche"
        " diese Fläche macht, bleibt sie erhalten"
    ),
    "Preview": "Vorschau",
    "Color the faces that would be refined over the scene's frames, or its preview range, and draw the new edges": (
        "Die Flächen färben, die für die Bilder der Szene oder ihren Vorschaubereich verfeinert würden, und die neuen"
        " Kanten zeichnen"
    ),
    "{count:,} of {all:,} faces": "{count:,} von {all:,} Flächen",
    "{vertices:,} vertices afterwards": "danach {vertices:,} Punkte",
    "{vertices:,} vertices or more afterwards": "danach {vertices:,} Punkte oder mehr",
    "{count:,} faces ask for more than {levels} levels": "{count:,} Flächen verlangen mehr als {levels} Stufen",
    "{count:,} of {all:,} faces refined, {vertices:,} vertices now": (
        "{count:,} von {all:,} Flächen verfeinert, jetzt {vertices:,} Punkte"
    ),
    "No face is refined: nothing there asks for more, or the threshold is too high": (
        "Keine Fläche wird verfeinert: Nichts verlangt dort mehr, oder die Schwelle ist zu hoch"
    ),
    "{modifier} was bound to the mesh as it was: bind it again": (
        "{modifier} war an das Netz gebunden, wie es war: neu binden"
    ),
    "The mesh is linked: refine it in its own file": "Das Netz ist verknüpft: in seiner eigenen Datei verfeinern",
    "The mesh is in Edit Mode: leave it first": "Das Netz ist im Bearbeitungsmodus: zuerst verlassen",
    "{object} has a Multiresolution modifier: apply it, or refine before sculpting": (
        "{object} hat einen Modifikator Multiauflösung: anwenden, oder vor dem Modellieren verfeinern"
    ),
    "Two faces have the same vertices: merge vertices by distance, or delete one": (
        "Zwei Flächen haben dieselben Punkte: Punkte nach Abstand verschmelzen oder eine löschen"
    ),
    # Any stack
    "Move Turgor Volume directly below the last Armature modifier": (
        "Turgor Volume direkt unter den letzten Armatur-Modifikator verschieben"
    ),
    "Move Turgor above It": "Turgor darüber verschieben",
    "Move Turgor Volume directly above this modifier": "Turgor Volume direkt über diesen Modifikator verschieben",
    "Plain Parent": "Einfaches Elternobjekt",
    "Let the parent move the object without deforming its mesh": (
        "Das Elternobjekt das Objekt bewegen lassen, ohne sein Netz zu verformen"
    ),
    "No Armature modifier before Turgor Volume: move Turgor Volume directly below it": (
        "Kein Armatur-Modifikator vor Turgor Volume: Turgor Volume direkt darunter verschieben"
    ),
    "Nothing poses the mesh: give it an Armature (Object > Parent > Armature Deform) or another deforming modifier": (
        "Nichts verformt das Netz: ihm eine Armatur geben (Objekt > Eltern > Armatur-Verformung) oder einen"
        " anderen verformenden Modifikator"
    ),
    "The parent {parent} deforms the mesh before all modifiers: make it a plain parent, and let a modifier deform": (
        "Das Elternobjekt {parent} verformt das Netz vor allen Modifikatoren: zum einfachen Elternobjekt machen"
        " und einen Modifikator verformen lassen"
    ),
    "{modifier} simulates, and what stands before Turgor Volume has to be the same however a frame is reached:"
    " move it after Turgor Volume": (
        "{modifier} simuliert, und was vor Turgor Volume steht, muss gleich sein, wie auch immer ein Bild"
        " erreicht wird: hinter Turgor Volume verschieben"
    ),
    "{modifier} makes other vertices from frame to frame: move it after Turgor Volume": (
        "{modifier} macht von Bild zu Bild andere Vertices: hinter Turgor Volume verschieben"
    ),
    "{modifier} deforms again after Turgor Volume: move Turgor Volume below it": (
        "{modifier} verformt nach Turgor Volume noch einmal: Turgor Volume darunter verschieben"
    ),
    "{modifier} makes other vertices or faces after what the body is: move Turgor Volume above it": (
        "{modifier} macht andere Vertices oder Flächen, als der Körper hat: Turgor Volume darüber verschieben"
    ),
    "The character is linked and its stack is read as Blender evaluates it: open its file with this version and"
    " save it, or make a library override": (
        "Die Figur ist verlinkt, und ihr Stapel wird gelesen, wie Blender ihn auswertet: ihre Datei mit dieser"
        " Version öffnen und speichern oder eine Bibliotheksüberschreibung anlegen"
    ),
    "On this frame the stack makes {found:,} vertices or other faces, {bound:,} vertices were bound: press Rebind": (
        "In diesem Bild macht der Stapel {found:,} Vertices oder andere Flächen, {bound:,} Vertices wurden"
        " gebunden: Neu binden drücken"
    ),
    "{modifier} makes other vertices or faces on this frame ({found:,} vertices, {bound:,} were bound): apply"
    " it, or move it after Turgor Volume": (
        "{modifier} macht in diesem Bild andere Vertices oder Flächen ({found:,} Vertices, {bound:,} wurden"
        " gebunden): anwenden oder hinter Turgor Volume verschieben"
    ),
    "The carrier of the character is gone: press Rebind": "Der Träger der Figur fehlt: Neu binden drücken",
    "What Blender evaluates for the character is not there yet: press Rebind": (
        "Was Blender für die Figur auswertet, ist noch nicht da: Neu binden drücken"
    ),
    "Read as Blender evaluates it, which takes longer: {reason}": (
        "Gelesen, wie Blender es auswertet, was länger dauert: {reason}"
    ),
    "Read as Blender evaluates it, which takes longer: {reason}; and {count} more reasons": (
        "Gelesen, wie Blender es auswertet, was länger dauert: {reason}; und {count} weitere Gründe"
    ),
    "{modifier} poses it without an Armature": "{modifier} verformt es ohne Armatur",
    "{modifier} moves it after the Armature": "{modifier} bewegt es nach der Armatur",
    "{modifier} uses Multi Modifier": "{modifier} benutzt Multi-Modifikator",
    "{modifier} has animated settings": "{modifier} hat animierte Einstellungen",
    "{modifier} may move the mesh before it is posed": "{modifier} kann das Netz bewegen, bevor es verformt wird",
    "{modifier} is animated before it is posed": "{modifier} ist animiert, bevor es verformt wird",
    "{modifier} changes shape keys before it is posed": "{modifier} ändert Formschlüssel, bevor es verformt wird",
    "{modifier} follows {other}, which may move": "{modifier} folgt {other}, das sich bewegen kann",
    "{mesh} is animated itself": "{mesh} ist selbst animiert",
    "its shape keys are absolute": "seine Formschlüssel sind absolut",
    "points of its shape keys are animated": "Punkte seiner Formschlüssel sind animiert",
    "a driver of its shape keys calls {function}, which may rewrite them": (
        "ein Treiber seiner Formschlüssel ruft {function} auf und schreibt sie vielleicht neu"
    ),
    "{handler} is called on every frame and may rewrite its shape keys": (
        "{handler} wird in jedem Bild aufgerufen und schreibt seine Formschlüssel vielleicht neu"
    ),
    "Corrective keys cannot follow a stack that is read as Blender evaluates it ({reason}): choose absolute"
    " keys or a point cache, or export USD or Alembic": (
        "Korrekturschlüssel können einem Stapel nicht folgen, der gelesen wird, wie Blender ihn auswertet"
        " ({reason}): absolute Schlüssel oder einen Punktcache wählen oder USD oder Alembic exportieren"
    ),
    "Turgor Volume is off: turn it on to see its figures for this stack": (
        "Turgor Volume ist aus: einschalten, um seine Zahlen für diesen Stapel zu sehen"
    ),
}
