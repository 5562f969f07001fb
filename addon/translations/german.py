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
    "Solver": "Löser",
    "How the joints share the work": "Wie die Gelenke sich die Arbeit teilen",
    "Simultaneous": "Gleichzeitig",
    "All joints at once: the order of bones never matters": (
        "Alle Gelenke auf einmal: Die Reihenfolge der Knochen ist ohne Bedeutung"
    ),
    "Sequential": "Nacheinander",
    "Joint after joint, parents first": "Gelenk für Gelenk, Eltern zuerst",
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
    "Flesh": "Fleisch",
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
}
